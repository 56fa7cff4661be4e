"""Nodes as data, and modifiers laid around them."""

from collections.abc import Mapping
from typing import Any

Data = dict[str, Any]
# Modifiers, outermost first.
ORDER = ("if", "once", "while", "timeout", "retry", "on_failure", "optional", "on_halt")
ALWAYS: Mapping[str, Any] = {"check": True}
NEVER: Mapping[str, Any] = {"check": False}
LEFT_OUT: Mapping[str, Any] = {"check": True, "if": False}
_KIND_KEYS = {"then": ("if",), "else": ("while",)}  # of if/then/else and while/do/else
_NO_FAILURE = ("retry", "on_failure")  # outside `optional` they would see no failure


def wrapped(node: Data, modifier: str, value: Any) -> Data:
    """Return a node with a modifier around it, in its own mapping where that means the same."""
    is_dead = modifier in _NO_FAILURE and node.get("optional")
    if is_outermost(node, modifier) and not is_dead and modifier not in node:
        return {**node, modifier: value}
    return {"do": node, modifier: value}


def is_outermost(node: Data, modifier: str) -> bool:
    """Whether a modifier would be, or is, the outermost one of a node."""
    own = [key for mark, keys in _KIND_KEYS.items() if mark in node for key in keys]
    outer = ORDER[: ORDER.index(modifier)]
    return not any(key in node and key not in own for key in outer)


def may_be_left_out(node: Any) -> bool:
    """Whether a node, or one within it that decides for it, may be left out."""
    if isinstance(node, list):
        return any(may_be_left_out(one) for one in node)
    if not isinstance(node, dict):
        return False
    if node.get("else") == "skip":
        return True
    if "once" in node or ("if" in node and ("then" not in node or "else" not in node)):
        return True
    return any(may_be_left_out(value) for key, value in node.items() if key != "on_failure")
