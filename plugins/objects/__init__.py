"""Plugins that keep the database of stones."""
