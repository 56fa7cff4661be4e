"""Filters: an error-state Kalman filter with a lidar clone, and one of position and inertia."""
