"""What an operator may order of a leaf: to be skipped, or begun again."""

from dataclasses import dataclass
from typing import Literal

from executive.tree.leaf_use import LeafUse


@dataclass(frozen=True, slots=True)
class Order:
    """An order.

    Attributes:
        kind: `skip` cancels the leaf and counts it as done; `retry` cancels it and begins it again.
        by: Who gave it.
    """

    kind: Literal["skip", "retry"]
    by: str


def refusal(use: LeafUse, order: Order, *, is_under_way: bool) -> str:
    """Return why an order is refused; empty if it is not.

    Args:
        use: The leaf.
        order: The order.
        is_under_way: The leaf has begun and not ended.
    """
    leaf = use.leaf
    if leaf.is_irreversible and is_under_way:
        return (
            f"{use.name} cannot be taken back and is under way: how far it is, is not known; wait "
            "for its end, or stop the mission"
        )
    written = [name for name, port in leaf.outputs.items() if not port.optional]
    if order.kind == "skip" and written:
        return (
            f"{use.name} writes {', '.join(map(repr, written))}, which other nodes read; it cannot "
            "be skipped"
        )
    return ""
