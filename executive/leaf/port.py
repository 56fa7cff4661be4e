"""A typed connection between a leaf and the mission's store."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Port:
    """An input or output of a leaf.

    Attributes:
        type: Class of the value, or `list[X]` for a list of them; `object` takes anything.
        doc: One line on meaning, frame and unit.
        optional: An input that may be left unconnected (the leaf gets None), an output that may
            stay unwritten.
    """

    type: Any
    doc: str
    optional: bool = False
