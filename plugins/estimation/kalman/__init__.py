"""The error-state Kalman filter, apart from what it estimates by."""
