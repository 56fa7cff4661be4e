"""Which nodes of a tree runs have ticked, and how these ended."""
