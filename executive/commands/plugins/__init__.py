"""The verbs on what is installed."""
