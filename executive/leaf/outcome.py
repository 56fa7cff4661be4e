"""How a leaf ended."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True, slots=True)
class Outcome:
    """Success with outputs, or failure with a reason a person understands.

    Attributes:
        success: Whether the leaf did what it says.
        reason: Why not; or, for a success, what is worth a line in the journal.
        outputs: Values of output ports by name.
    """

    success: bool
    reason: str = ""
    outputs: Mapping[str, Any] = field(default_factory=dict)


def succeeded(reason: str = "", **outputs: Any) -> Outcome:
    """Return a success that writes these output ports."""
    return Outcome(True, reason, outputs)


def failed(reason: str, **outputs: Any) -> Outcome:
    """Return a failure; outputs are written all the same, so that a recovery can read them."""
    return Outcome(False, reason, outputs)
