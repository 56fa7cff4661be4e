"""monitoring plugins."""
