"""registration plugins."""
