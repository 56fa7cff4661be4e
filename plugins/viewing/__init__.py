"""Plugins that show a mission."""
