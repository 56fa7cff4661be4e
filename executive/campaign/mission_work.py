"""Whole missions as bulk work."""
