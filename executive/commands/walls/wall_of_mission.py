"""Lays a file of a structure over a mission that builds one: `executive run --wall WALL.yaml`."""

from pathlib import Path

from executive.commands.walls.structure_file import read_structure
from executive.leaf.structure_shape import StructureShape
from executive.tree.document import read_file
from executive.tree.override import Override, PlacedSetting
from executive.tree.problem import Mark, Problems
from executive.tree.value import Listing, Scalar, Table, TableEntry, Value

_TREE, _LEAF = "the_wall", "DescribeStructure"
_NAME, _PLANNER = "structure", "building"


def wall_of_mission(path: Path) -> tuple[list[Override], list[str]]:
    """Return what a file says of a mission, and those of its keys that say nothing of one.

    The structure takes the place of the mission's tree `the_wall`; the planner's settings are laid
    over the mission's. What concerns stones and noise of a trial is left out.

    Raises:
        MissionFileError: If the file is wrong; each mistake is told with file, line and column.
        ConfigError: If it describes no structure.
    """
    read_structure(path)
    document = read_file(path, str(path), Problems(), "structure")
    if not isinstance(document, Table):  # read_structure has refused it
        return [], []
    entries = document.entries
    shape = {k: e for k, e in entries.items() if k in StructureShape.model_fields}
    named = {"label": entries[_NAME]} if _NAME in entries else {}
    mark = document.mark
    leaf = _table(mark, check=Scalar(_LEAF, mark), **{"with": Table({**named, **shape}, mark)})
    out = _table(mark, structure=Scalar("Structure", mark))
    tree = _table(mark, out=out, sequence=Listing((leaf,), mark))
    settings: list[Override] = [PlacedSetting(f"trees.{_TREE}", tree, mark)]
    planner = entries.get(_PLANNER)
    if planner is not None:
        settings += _leaves(_PLANNER, planner)
    unused = [key for key in entries if key not in (*shape, _NAME, _PLANNER)]
    return settings, unused


def _leaves(key: str, entry: TableEntry) -> list[PlacedSetting]:
    """Return each setting of a table by its whole key; which plugin it is comes first."""
    if not isinstance(entry.value, Table):
        return [PlacedSetting(key, entry.value, entry.key_mark)]
    inner = sorted(entry.value.entries.items(), key=lambda one: one[0] != "plugin")
    return [leaf for name, one in inner for leaf in _leaves(f"{key}.{name}", one)]


def _table(mark: Mark, **values: Value) -> Table:
    return Table({key: TableEntry(mark, value) for key, value in values.items()}, mark)
