"""grasping plugins."""
