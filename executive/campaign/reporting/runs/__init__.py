"""Single runs: the report of one, and two side by side."""
