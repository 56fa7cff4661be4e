"""The kinds of nodes with the keys beside each, and the modifiers."""

from collections.abc import Mapping

from executive.tree.instances import USE
from executive.tree.leaf_reader import LEAF_KEYS

# Each kind and the keys beside it.
KINDS: Mapping[str, tuple[str, ...]] = {
    "sequence": (),
    "fallback": (),
    "reactive_sequence": (),
    "reactive_fallback": (),
    "persistent_sequence": (),
    "parallel": ("succeed", "fail", "wait_for_all"),
    "not": (),
    "force_failure": (),
    "then": ("if", "else"),
    "switch": ("cases", "else"),
    "loop": ("do",),
    "for_each": ("do",),
    "consume": ("do",),
    "run": LEAF_KEYS,
    "check": LEAF_KEYS,
    "wait": (),
    "set": (),
    "ask": ("default", "choices", "out"),
    "call": ("in", "out", USE),
    "do": ("else",),  # with `while` and `else` a kind of its own; else it carries modifiers
}
SKIP = "skip"  # as an `else`: the node is left out
REPEATING = ("loop", "for_each", "consume")  # beside them, `do` is their body
MODIFIERS = (
    "if",
    "once",
    "while",
    "timeout",
    "retry",
    "on_failure",
    "optional",
    "on_halt",
    "name",
)
ELSE_GOES_WITH = (
    "'else' goes with 'if' and 'then', with 'while' and 'do', or with 'switch' and 'cases'"
)
