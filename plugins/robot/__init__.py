"""Plugins that are robots."""
