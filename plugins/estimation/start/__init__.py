"""The first state of an estimator: at rest or from motion, with gravity and antennas."""
