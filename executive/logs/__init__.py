"""Recorded logs: ROS messages in MCAP files and bags, read and written as own messages."""
