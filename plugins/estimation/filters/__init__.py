"""Kalman filters: with inertial and satellite measurements, and with lidar in addition."""
