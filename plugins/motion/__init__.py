"""motion plugins."""
