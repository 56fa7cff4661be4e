"""Dry-stone building: found stones, stacked without mortar."""
