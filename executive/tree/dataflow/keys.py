"""The types that each key of a store may hold at one point of the order of execution.

The table is changed in place, and what changed is logged, so that a branch can be followed and
taken back. Every step costs what the branch wrote, and never the number of keys: a tree is checked
in a time that grows with its nodes.
"""

from collections.abc import Iterator, Mapping
from typing import Any

Types = frozenset[Any]

UNKNOWN: Types = frozenset({Any})
TEXT: Types = frozenset({str})
ANYTHING = "*"  # means every key, after a node that could not be read
_NONE: Types = frozenset()


class Keys(Mapping[str, Types]):
    """The types of each key now, and every write so far."""

    def __init__(self, types: Mapping[str, Types]) -> None:
        self._types = dict(types)
        self._changes: list[tuple[str, Types | None]] = []  # a key, and its types before
        self._writes: list[tuple[str, Types]] = []

    def __getitem__(self, key: str) -> Types:
        return self._types[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._types)

    def __len__(self) -> int:
        return len(self._types)

    def __contains__(self, key: object) -> bool:
        return key in self._types

    def change(self, key: str, types: Types) -> None:
        """Let a key hold these types from now on, without a node that writes it."""
        self._changes.append((key, self._types.get(key)))
        self._types[key] = types

    def write(self, new: Mapping[str, Types]) -> None:
        """Take what a node writes; the types before are replaced."""
        for key, types in new.items():
            self._writes.append((key, types or UNKNOWN))
            self.change(key, types or UNKNOWN)

    def join(self, other: Mapping[str, Types]) -> None:
        """Add the types that keys hold on another way to this point."""
        for key, types in other.items():
            known = self._types.get(key, _NONE)
            if not types <= known or key not in self._types:
                self.change(key, known | types)

    # --- branches

    def point(self) -> int:
        """Return the present point, for `rewind`."""
        return len(self._changes)

    def rewind(self, point: int) -> dict[str, Types]:
        """Take back all changes since a point; return the keys that had changed, as they were."""
        changed = {key: self._types[key] for key, _ in self._changes[point:] if key in self._types}
        for key, before in reversed(self._changes[point:]):
            if before is None:
                self._types.pop(key, None)
            else:
                self._types[key] = before
        del self._changes[point:]
        return changed

    def writes(self) -> int:
        """Return the number of writes so far, for `spoil`."""
        return len(self._writes)

    def spoil(self, start: int) -> None:
        """Let hold whatever the nodes since `start` wrote, if they did any part of it."""
        for key, types in self._writes[start:]:
            self.join({key: types})
