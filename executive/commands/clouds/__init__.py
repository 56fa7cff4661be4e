"""The verbs on clouds from files."""
