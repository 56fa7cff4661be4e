"""Points from E57 files, which hold scans in frames of their own, each with its pose.

Only the server of confined readings imports this file.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pye57 import libe57

from executive.arrays import Float
from executive.clouds.carried_fields import CarriedFields
from executive.clouds.e57_header import check_e57
from executive.clouds.file_cloud import FileCloud
from executive.clouds.point_collector import CHUNK, PointCollector
from executive.errors import DataError

_CARTESIAN = ("cartesianX", "cartesianY", "cartesianZ")
_SPHERICAL = ("sphericalRange", "sphericalAzimuth", "sphericalElevation")
_COLOUR = ("colorRed", "colorGreen", "colorBlue")
_INTENSITY = "intensity"
_UNIT_SLACK = 1e-3  # by which the length of a quaternion of printed digits may differ from one
_SHOWN = 120  # characters of what the library says


@dataclass(frozen=True, slots=True)
class _Scan:
    """One scan of a file.

    Attributes:
        points: The library's node of its points.
        fields: Kind of the numbers of each field, by its name.
        colour_depth: `u1`, `u2`, or empty if it has no colour in whole numbers.
        R: Rotation of its pose, shape (3, 3).
        t: Translation of its pose [m], shape (3,).
    """

    points: Any
    fields: dict[str, Any]
    colour_depth: str
    R: Float
    t: Float


def e57_points(path: Path) -> tuple[Float]:
    """Return the points of all scans of an E57 file, moved by their poses [m], shape (N, 3).

    Raises:
        DataError: If it is cut short or damaged, or a scan has no coordinates.
    """
    return (_read(path, is_whole=False)[0],)


def e57_cloud(path: Path) -> tuple[np.ndarray, ...]:
    """Return points, colour, intensity, and the names of what was left out.

    Returns:
        Points [m], shape (N, 3); colour, shape (N, 3) or (0, 3); intensity, shape (N,) or (0,);
        names in UTF-8 with a line each, as bytes.

    Raises:
        DataError: As `e57_points`.
    """
    points, carried, left_out = _read(path, is_whole=True)
    cloud = FileCloud.of(points, carried, left_out)
    colour = np.empty((0, 3), np.uint8) if cloud.colour is None else cloud.colour
    intensity = np.empty(0, np.float32) if cloud.intensity is None else cloud.intensity
    return points, colour, intensity, np.frombuffer("\n".join(left_out).encode(), np.uint8)


def e57_crs(path: Path) -> tuple[np.ndarray]:
    """Return the text that names a file's coordinate system, in UTF-8, as bytes.

    Raises:
        DataError: If the file is damaged.
    """
    check_e57(path)
    try:
        image = libe57.ImageFile(str(path), "r")  # nodes need it as long as they are read
        root = image.root()
        name = root["coordinateMetadata"].value() if root.isDefined("coordinateMetadata") else ""
    except libe57.E57Exception as error:
        raise _damage(path, error) from error
    return (np.frombuffer(str(name).encode(), np.uint8),)


def _read(path: Path, is_whole: bool) -> tuple[Float, np.ndarray | None, tuple[str, ...]]:
    check_e57(path)
    try:
        image = libe57.ImageFile(str(path), "r")
        scans = list(_scans(path, image.root()))
        fields = _carried(scans) if is_whole else CarriedFields()
        collector = PointCollector(path, sum(one.points.childCount() for one in scans), fields)
        for scan in scans:
            _collect(path, image, scan, fields, collector)
    except libe57.E57Exception as error:
        raise _damage(path, error) from error
    read = {*_CARTESIAN, *_SPHERICAL, *fields.names, *map(_invalid, scans)}
    left_out = sorted({name for one in scans for name in one.fields} - read)
    return *collector.with_carried(), tuple(left_out)


def _scans(path: Path, root: Any) -> Iterator[_Scan]:
    """Yield the scans of a file."""
    if not root.isDefined("data3D"):
        return
    data = root["data3D"]
    for number in range(data.childCount()):
        node = data[number]
        points = node["points"]
        prototype = libe57.StructureNode(points.prototype())
        kinds = [prototype.get(i) for i in range(prototype.childCount())]
        fields = {one.elementName(): one.type() for one in kinds}
        if not (fields.keys() >= set(_CARTESIAN) or fields.keys() >= set(_SPHERICAL)):
            raise DataError(
                f"{path}: scan {number} has no coordinates, but {', '.join(fields)}; export it as "
                "a point cloud"
            )
        yield _Scan(points, fields, _depth(node, fields), *_pose(path, number, node))


def _pose(path: Path, number: int, node: Any) -> tuple[Float, Float]:
    """Return rotation (3, 3) and translation [m] (3,) of a scan; what is not given is none."""
    q, t = np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3)
    pose = node["pose"] if node.isDefined("pose") else None
    if pose is not None and pose.isDefined("rotation"):
        q = np.array([pose["rotation"][name].value() for name in "wxyz"], dtype=float)
    if pose is not None and pose.isDefined("translation"):
        t = np.array([pose["translation"][name].value() for name in "xyz"], dtype=float)
    length = float(np.linalg.norm(q))
    if not (abs(length - 1) < _UNIT_SLACK and np.isfinite(t).all()):
        raise DataError(
            f"{path}: the pose of scan {number} is none (a quaternion of length {length:.3g}); "
            "export it again"
        )
    w, x, y, z = q / length
    R = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    return R, t


def _depth(node: Any, fields: dict[str, Any]) -> str:
    """Return NumPy's type of a channel of a scan's colour, by the limits that the file states."""
    if any(fields.get(name) != libe57.NodeType.E57_INTEGER for name in _COLOUR):
        return ""
    limits = node["colorLimits"] if node.isDefined("colorLimits") else None
    names = [f"{name}Maximum" for name in _COLOUR]
    most = [limits[name].value() for name in names if limits is not None and limits.isDefined(name)]
    return "u2" if any(one > 255 for one in most) else "u1"


def _carried(scans: list[_Scan]) -> CarriedFields:
    """Return the fields that all scans have, with colours of one depth."""
    depths = {one.colour_depth for one in scans}
    has_colour = len(depths) == 1 and depths != {""}
    has_intensity = bool(scans) and all(_INTENSITY in one.fields for one in scans)
    return CarriedFields(
        _COLOUR if has_colour else (),
        depths.pop() if has_colour else "u1",
        _INTENSITY if has_intensity else "",
    )


def _collect(
    path: Path, image: Any, scan: _Scan, fields: CarriedFields, collector: PointCollector
) -> None:
    """Read a scan piece by piece."""
    is_cartesian = scan.fields.keys() >= set(_CARTESIAN)
    axes = _CARTESIAN if is_cartesian else _SPHERICAL
    invalid = [name for name in [_invalid(scan)] if name in scan.fields]
    buffers, wanted = libe57.VectorSourceDestBuffer(), (*axes, *fields.names, *invalid)
    columns = {name: np.empty(min(CHUNK, max(1, scan.points.childCount()))) for name in wanted}
    for name, column in columns.items():
        # Converted to double precision, and scaled where the file has whole numbers of steps.
        buffers.append(libe57.SourceDestBuffer(image, name, column, len(column), True, True))
    reader = scan.points.reader(buffers)
    found = 0
    while count := reader.read():
        found += count
        piece = {name: column[:count] for name, column in columns.items()}
        local = np.column_stack([piece[name] for name in axes])
        with np.errstate(over="ignore", invalid="ignore"):  # what is not finite is left out
            placed = (local if is_cartesian else _cartesian(local)) @ scan.R.T + scan.t
        for name in invalid:
            placed[piece[name] != 0] = np.nan
        collector.add(placed[:, 0], placed[:, 1], placed[:, 2], piece)
    reader.close()
    promised = scan.points.childCount()
    if found < promised:
        raise DataError(
            f"{path}: cut short: a scan promises {promised} points and has {found}; copy or export "
            "it again"
        )


def _invalid(scan: _Scan) -> str:
    """Return the field that marks points without a return."""
    is_cartesian = scan.fields.keys() >= set(_CARTESIAN)
    return "cartesianInvalidState" if is_cartesian else "sphericalInvalidState"


def _cartesian(spherical: Float) -> Float:
    """Return points of range [m], azimuth and elevation [rad] (ASTM E2807, Sec. 6.1.4)."""
    distance, azimuth, elevation = spherical.T
    level = distance * np.cos(elevation)
    return np.column_stack(
        [level * np.cos(azimuth), level * np.sin(azimuth), distance * np.sin(elevation)]
    )


def _damage(path: Path, error: Exception) -> DataError:
    said = " ".join(str(error).split())[:_SHOWN]
    return DataError(f"{path}: cut short or damaged ({said}); copy or export it again")
