"""Recorded logs: ROS messages in MCAP files and bags, converted to and from own messages."""
