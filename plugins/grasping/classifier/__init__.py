"""A network that predicts from grasp images and costs whether a lift succeeds."""
