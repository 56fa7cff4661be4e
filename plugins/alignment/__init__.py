"""Alignment plugins."""
