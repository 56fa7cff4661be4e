"""Driving: paths of arcs and straight lines over ground that the map shows."""
