"""Lidar odometry: increments of the sensor's pose from scans."""
