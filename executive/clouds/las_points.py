"""Points from LAS and LAZ files, which store integers with a scale and an offset.

Only the server of confined readings imports this file.
"""

import struct
import sys
from pathlib import Path
from typing import Any

import numpy as np

from executive.arrays import Float
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
            collector = PointCollector(path, file.header.point_count)
            for rows in file.chunk_iterator(CHUNK):
                collector.add(rows.x, rows.y, rows.z)
            points = collector.points()
            _check_box(path, file.header, points)
    except damage as error:
        raise DataError(
            f"{path}: cut short or damaged ({error}); copy or export it again"
        ) from error
    return (points,)


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
