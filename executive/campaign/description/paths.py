"""Relative paths in a campaign file, made absolute, so that a run may happen in any folder."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from executive.tree.problem import Mark
from executive.tree.value import Listing, Scalar, Table, TableEntry, Value

# A text at a place; one option may hold several.
Place = tuple[Mark, str]


@dataclass(slots=True)
class Paths:
    """The relative paths of a campaign that were found so far.

    Attributes:
        folder: The folder of the campaign file: its paths are relative to it. Those of options are
            relative to the current folder.
        places: Where they are.
    """

    folder: Path
    places: set[Place] = field(default_factory=set)

    def add(self, places: Iterable[Place]) -> None:
        """Take note of relative paths."""
        self.places.update(places)

    def absolute(self, mark: Mark, text: str) -> Path:
        """Return the absolute form of a path at a place."""
        folder = Path.cwd() if mark.file.startswith("--") else self.folder
        return (folder / text).resolve()

    def made_absolute(self, value: Value) -> Value:
        """Return a value with all paths that were noted made absolute."""
        if isinstance(value, Table):
            entries = {
                key: TableEntry(entry.key_mark, self.made_absolute(entry.value))
                for key, entry in value.entries.items()
            }
            return Table(entries, value.mark)
        if isinstance(value, Listing):
            return Listing(tuple(self.made_absolute(item) for item in value.items), value.mark)
        if isinstance(value, Scalar) and (value.mark, value.value) in self.places:
            return Scalar(str(self.absolute(value.mark, str(value.value))), value.mark)
        return value


def relative_paths(value: Value, checked: Any) -> Iterator[Place]:
    """Yield the places of relative paths in a value.

    Args:
        value: What the file says.
        checked: The same after it was checked: fields of the type Path are paths. A text that
            begins with `./` or `../` is one in any field.
    """
    if isinstance(value, Table):
        for key, entry in value.entries.items():
            yield from relative_paths(entry.value, part_at(checked, key))
    elif isinstance(value, Listing):
        parts = checked if isinstance(checked, list | tuple) else ()
        for index, item in enumerate(value.items):
            yield from relative_paths(item, parts[index] if index < len(parts) else None)
    elif isinstance(value, Scalar) and isinstance(value.value, str):
        is_path = isinstance(checked, Path) or value.value.startswith(("./", "../"))
        if is_path and not Path(value.value).is_absolute():
            yield value.mark, value.value


def part_at(checked: Any, path: str) -> Any:
    """Return the part of checked settings at a path such as `site.stones`, or None."""
    for key in path.split(".") if path else ():
        if isinstance(checked, BaseModel):
            checked = getattr(checked, key, None)
        else:
            checked = checked.get(key) if isinstance(checked, Mapping) else None
    return checked
