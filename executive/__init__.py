"""A plugin-based behaviour-tree task executive for machines that move found stones."""
