"""A campaign file, checked, and the trials that follow from it."""
