"""The mission language: YAML to a checked description, to py_trees nodes, and to pictures of it."""
