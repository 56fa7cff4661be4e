"""placing plugins."""
