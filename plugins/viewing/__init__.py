"""viewing plugins."""
