"""Files of maps: a PLY cloud, and beside it a JSON file with the frame, its origin on the earth,
and the chassis' pose.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from executive.arrays import Float, checked
from executive.clouds.ply_writer import write_ply
from executive.clouds.reader import read_points
from executive.errors import DataError, ShapeError
from executive.messages.cloud import Cloud

_KEYS = ("frame", "stamp_s", "T_map_base")
_DATUM = "datum"  # maps that were saved before it was kept have none
_DAMAGED = (OSError, ValueError, KeyError, TypeError, ArithmeticError, RecursionError, ShapeError)


@dataclass(frozen=True, slots=True, eq=False)
class MapFile:
    """A map that was saved.

    Attributes:
        cloud: Its points, in the frame that they were saved in.
        stamp_s: Mission time at which it was saved [s].
        T_map_base: Pose of the chassis at that moment, shape (4, 4); None for a cloud that no
            mission saved.
        datum: Where the frame's origin is: latitude [deg], longitude [deg], altitude above the
            ellipsoid [m], shape (3,); the frame is east, north and up there. None if nobody knows.
    """

    cloud: Cloud
    stamp_s: float
    T_map_base: Float | None
    datum: Float | None = None


def write_map(path: Path, saved: MapFile) -> None:
    """Write a map, each of its two files whole or not at all.

    Raises:
        OSError: If a file cannot be written.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f"{path.name}.partial")
    write_ply(partial, saved.cloud.points, saved.cloud.frame)
    pose = None if saved.T_map_base is None else saved.T_map_base.tolist()
    values = (saved.cloud.frame, saved.stamp_s, pose)
    datum = None if saved.datum is None else saved.datum.tolist()
    text = json.dumps({**dict(zip(_KEYS, values, strict=True)), _DATUM: datum}, indent=1)
    beside = _beside(path)
    beside.with_name(f"{beside.name}.partial").write_text(f"{text}\n", encoding="utf-8")
    partial.replace(path)
    beside.with_name(f"{beside.name}.partial").replace(beside)


def read_map(path: Path) -> MapFile:
    """Read a map; a cloud without its JSON file is in a frame of its own, called as the file is.

    Raises:
        DataError: If a file is missing or damaged.
    """
    points = read_points(path)
    beside = _beside(path)
    if not beside.is_file():
        return MapFile(Cloud(path.stem, points), 0.0, None)
    try:
        found = json.loads(beside.read_text(encoding="utf-8"))
        frame, stamp_s, pose = (found[key] for key in _KEYS)
        T = None if pose is None else checked("T_map_base", np.array(pose, dtype=float), 4, 4)
        return MapFile(Cloud(str(frame), points), float(stamp_s), T, _datum(found.get(_DATUM)))
    except _DAMAGED as error:
        raise DataError(f"{beside}: not the description of a saved map: {error}") from error


def _datum(found: object) -> Float | None:
    """Return where a map's origin is.

    Raises:
        ShapeError: If it is no three numbers.
        ValueError: If it is no place on the earth.
    """
    if found is None:
        return None
    datum = checked(_DATUM, np.array(found, dtype=float), 3)
    if abs(datum[0]) > 90 or abs(datum[1]) > 360:
        raise ValueError(f"{_DATUM}: {datum[0]:g}, {datum[1]:g} is no latitude and longitude")
    return datum


def _beside(path: Path) -> Path:
    return path.with_suffix(".json")
