"""mapping plugins."""
