"""Points from LAS and LAZ files, which store integers with a scale and an offset.

Only the server of confined readings imports this file.
"""

import struct
import sys
from pathlib import Path
from typing import Any

import numpy as np

from executive.arrays import Float
from executive.clouds.carried_fields import CarriedFields
from executive.clouds.file_cloud import FileCloud
from executive.clouds.point_collector import CHUNK, PointCollector
from executive.errors import DataError

# laspy imports its client for files on the network, which takes longer than all else here.
sys.modules.setdefault("requests", None)  # type: ignore[arg-type]
import laspy  # noqa: E402
import lazrs  # noqa: E402

_LINEAR_UNITS_KEY = 3076  # GeoTIFF: ProjLinearUnitsGeoKey
_MODEL_TYPE_KEY, _GEOGRAPHIC = 1024, 2  # GeoTIFF: GTModelTypeGeoKey; latitude and longitude
_METRE = 9001  # EPSG
_UNITS = {9002: "feet", 9003: "US survey feet"}
_BOX_SLACK = 0.01  # share of the header's box by which a point may lie outside it


def las_points(path: Path) -> tuple[Float]:
    """Return the points of a LAS or LAZ file [m], shape (N, 3).

    Raises:
        DataError: If it is cut short or damaged, or its coordinate system is not in metres.
    """
    points, _, _ = _read(path, is_whole=False)
    return (points,)


def las_cloud(path: Path) -> tuple[np.ndarray, ...]:
    """Return points, colour, intensity, and the steps and the beginning of coordinates.

    Returns:
        Points [m], shape (N, 3); colour as integers of 16 bits, shape (N, 3), or (0, 3) if the
        file has none; intensity, shape (N,); scales [m], shape (3,); offsets [m], shape (3,).

    Raises:
        DataError: As `las_points`.
    """
    points, carried, header = _read(path, is_whole=True)
    cloud = FileCloud.of(points, carried, ())
    colour = np.empty((0, 3), np.uint16) if cloud.colour is None else cloud.colour
    intensity = np.empty(0, np.float32) if cloud.intensity is None else cloud.intensity
    return points, colour, intensity, header.scales, header.offsets


def _read(path: Path, is_whole: bool) -> tuple[Float, np.ndarray | None, Any]:
    """Return the points of a file, what is carried with them if it is asked for, and the header."""
    damage = (
        laspy.errors.LaspyException,
        lazrs.LazrsError,
        ValueError,
        IndexError,
        KeyError,
        OSError,
        struct.error,
    )
    try:
        with laspy.open(path, laz_backend=laspy.LazBackend.Lazrs) as file:
            _check_header(path, file.header)
            fields = _fields(file.header) if is_whole else CarriedFields()
            collector = PointCollector(path, file.header.point_count, fields)
            for rows in file.chunk_iterator(CHUNK):
                carried = {name: np.asarray(rows[name]) for name in fields.names}
                collector.add(rows.x, rows.y, rows.z, carried)
            points, carried_rows = collector.with_carried()
            _check_box(path, file.header, points)
            return points, carried_rows, file.header
    except damage as error:
        raise DataError(
            f"{path}: cut short or damaged ({error}); copy or export it again"
        ) from error


def _fields(header: Any) -> CarriedFields:
    names = set(header.point_format.dimension_names)
    colour = ("red", "green", "blue")
    return CarriedFields(colour if names >= set(colour) else (), "u2", "intensity")


def _check_header(path: Path, header: Any) -> None:
    """Check that the header agrees with the file's size and that the unit is the metre."""
    if not (np.isfinite([*header.scales, *header.offsets]).all() and (header.scales > 0).all()):
        raise DataError(
            f"{path}: the scale {header.scales} or the offset {header.offsets} in its header is "
            "invalid; export it again"
        )
    wanted = header.offset_to_point_data + header.point_count * header.point_format.size
    if not header.are_points_compressed and path.stat().st_size < wanted:
        raise DataError(
            f"{path}: cut short: the header promises {header.point_count} points "
            f"({wanted} bytes), the file has "
            f"{path.stat().st_size} bytes; copy or export it again"
        )
    unit = _unit(header.vlrs)
    if unit:
        raise DataError(
            f"{path}: its header says that coordinates are in {unit}; project it to metres"
        )


def _unit(records: Any) -> str:
    """Return the unit of the file's coordinate system; empty if it is the metre or not given."""
    keys = {
        key.id: key.value_offset
        for record in records.get("GeoKeyDirectoryVlr")
        for key in record.geo_keys
    }
    if keys.get(_MODEL_TYPE_KEY) == _GEOGRAPHIC:
        return "degrees"
    if keys.get(_LINEAR_UNITS_KEY, _METRE) != _METRE:
        code = keys[_LINEAR_UNITS_KEY]
        return _UNITS.get(code, f"the unit EPSG:{code}")
    for record in records.get("WktCoordinateSystemVlr"):
        text = record.string.upper()
        if text.startswith("GEOGCS"):
            return "degrees"
        if "FOOT" in text or "FEET" in text:
            return "feet"
    return ""


def _check_box(path: Path, header: Any, points: Float) -> None:
    """Refuse points outside the bounding box in the header, because one of the two is damaged."""
    low, high = np.asarray(header.mins), np.asarray(header.maxs)
    if not (high > low).any():  # some programs do not write a box
        return
    slack = _BOX_SLACK * float((high - low).max()) + 2 * header.scales
    if (points.min(axis=0) < low - slack).any() or (points.max(axis=0) > high + slack).any():
        raise DataError(
            f"{path}: has points outside the bounding box in its header ({low} to {high}): one of "
            "the two is damaged; copy or export it again"
        )
