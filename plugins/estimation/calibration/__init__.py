"""Mounting, clocks and noise of the sensors on one body, found from a recording."""
