"""The verbs on recorded logs."""
