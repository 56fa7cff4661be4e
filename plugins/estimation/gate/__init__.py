"""Checks of measurements: order of stamps, and tests of position fixes."""
