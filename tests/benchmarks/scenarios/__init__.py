"""Simulated measurements with truth, and what can be wrong with them."""
