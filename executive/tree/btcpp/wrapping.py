"""Nodes as data, and modifiers laid around them."""

from collections.abc import Mapping
from typing import Any

Data = dict[str, Any]
ORDER = ("if", "once", "while", "timeout", "retry", "on_failure", "optional", "on_halt")  # outer first
ALWAYS: Mapping[str, Any] = {"check": True}
NEVER: Mapping[str, Any] = {"check": False}
LEFT_OUT: Mapping[str, Any] = {"check": True, "if": False}
_KIND_KEYS = {"then": ("if",), "else": ("while",)}  # of if/then/else and while/do/else
_NO_FAILURE = ("retry", "on_failure")  # outside `optional` they would see no failure


def wrapped(node: Data, modifier: str, value: Any) -> Data:
    """Return a node with a modifier around it, in one mapping with the node where that is the same."""
    place = ORDER.index(modifier)
    own = [key for mark, keys in _KIND_KEYS.items() if mark in node for key in keys]
    inner = all(ORDER.index(key) > place for key in node if key in ORDER and key not in own)
    is_dead = modifier in _NO_FAILURE and node.get("optional")
    if inner and not is_dead and modifier not in node:
        return {**node, modifier: value}
    return {"do": node, modifier: value}


def may_be_left_out(node: Any) -> bool:
    """Whether a node, or one within it that decides for it, may be left out."""
    if isinstance(node, list):
        return any(may_be_left_out(one) for one in node)
    if not isinstance(node, dict):
        return False
    if "once" in node or ("if" in node and ("then" not in node or "else" not in node)):
        return True
    return any(may_be_left_out(value) for key, value in node.items() if key != "on_failure")
