"""A campaign from its description to its results."""
