"""Estimation in the frame of the turning cabin: the sensors, their settings and the shared loop."""
