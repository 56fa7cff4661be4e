"""alignment plugins."""
