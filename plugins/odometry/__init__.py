"""odometry plugins."""
