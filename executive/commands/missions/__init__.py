"""The verbs on missions."""
