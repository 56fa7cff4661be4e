"""robot plugins."""
