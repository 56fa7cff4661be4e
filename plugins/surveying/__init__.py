"""surveying plugins."""
