"""Expressions on the keys of a tree: `{stone.mass} > 0.8 t and not {is_blocked}`."""
