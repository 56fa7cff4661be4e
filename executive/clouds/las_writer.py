"""Point clouds as LAS and LAZ files, with the records of their coordinate system."""

import re
import struct
from pathlib import Path
from typing import Any

import numpy as np

from executive.arrays import Float
from executive.clouds.file_cloud import FileCloud, Place
from executive.errors import DataError
from executive.extras import require_extra

_WKT, _GEO_KEYS = 2112, 34735  # records of LAS 1.4 R15 (ASPRS), Sec. 3
_PROJECTION = "LASF_Projection"
_MODEL_TYPE, _PROJECTED_MODEL, _PROJECTED = 1024, 1, 3072  # GeoTIFF keys of a projected system
_CODE = re.compile(r"EPSG:(\d{1,5})")
_MOST_CODE = 32766  # a GeoTIFF key has 16 bits, and 32767 stands for a system of its own
_STEP_M = 1e-4  # of coordinates that came from no LAS file: below the noise of any scanner
_MOST_STEPS = 2**31 - 1
_MOST_RECORD = 65535  # bytes: the length of a record has 16 bits
_FULL = 65535  # an intensity has 16 bits


def write_las(path: Path, cloud: FileCloud) -> tuple[str, ...]:
    """Write a cloud as LAS, or as LAZ by the name, and return what is changed.

    The steps and the beginning of the coordinates are those of the LAS file that the cloud came
    from, so that no coordinate changes; of other clouds the steps are 0.1 mm. The records of the
    coordinate system are written as they were read; of a name alone WKT stays text (LAS 1.4), and
    a code becomes a GeoTIFF key (LAS 1.2).

    Raises:
        MissingExtraError: If the packages that write it are not installed.
        DataError: If the format cannot hold the intensity or the coordinates.
    """
    require_extra(f"{path}: a LAS or LAZ file", "las")
    import laspy

    records = cloud.place.records or _records(path, cloud.place)
    if any(len(content) > _MOST_RECORD for _, content in records):
        raise DataError(
            f"{path}: a record of the coordinate system has more than {_MOST_RECORD} bytes; write "
            "a PLY or PCD file"
        )
    has_text = any(number == _WKT for number, _ in records)
    version, form = ("1.4", 6) if has_text else ("1.2", 0)
    header = laspy.LasHeader(
        version=version, point_format=form + (0 if cloud.colour is None else 1 if has_text else 2)
    )
    header.scales, header.offsets = _grid(path, cloud)
    header.global_encoding.wkt = has_text
    for number, content in records:
        header.vlrs.append(laspy.VLR(_PROJECTION, number, "", content))
    data = laspy.LasData(header)
    data.x, data.y, data.z = cloud.points.T
    changed = _colours(data, cloud) + _intensities(path, data, cloud)
    data.write(str(path))
    return changed


def _records(path: Path, place: Place) -> tuple[tuple[int, bytes], ...]:
    """Return the record that says the name of a coordinate system; none if there is no name."""
    if not place.crs:
        return ()
    code = _CODE.fullmatch(place.crs)
    if not code:
        return ((_WKT, place.crs.encode("ascii") + b"\0"),)
    if not 0 < int(code[1]) <= _MOST_CODE:
        raise DataError(
            f"{path}: a LAS file cannot hold the code {place.crs}; write a PLY or PCD file"
        )
    rows = ((1, 1, 0, 2), (_MODEL_TYPE, 0, 1, _PROJECTED_MODEL), (_PROJECTED, 0, 1, int(code[1])))
    return ((_GEO_KEYS, b"".join(struct.pack("<4H", *row) for row in rows)),)


def _grid(path: Path, cloud: FileCloud) -> tuple[Float, Float]:
    """Return steps and beginning of the coordinates [m], shape (3,) each."""
    low, high = cloud.points.min(axis=0), cloud.points.max(axis=0)
    if cloud.place.scales:
        return np.array(cloud.place.scales), np.array(cloud.place.offsets)
    offsets = np.floor(low)
    if ((high - offsets) / _STEP_M > _MOST_STEPS).any():
        raise DataError(
            f"{path}: {(high - low).max():.6g} m across is more than a LAS file holds in steps of "
            f"{_STEP_M:g} m; crop the cloud, or write a PLY file"
        )
    return np.full(3, _STEP_M), offsets


def _colours(data: Any, cloud: FileCloud) -> tuple[str, ...]:
    if cloud.colour is None:
        return ()
    # LAS 1.4 R15, Sec. 2.6: channels of 8 bits are normalised to 16; 257 · 255 = 65535.
    colour = cloud.colour.astype(np.uint16) * (257 if cloud.colour.dtype == np.uint8 else 1)
    data.red, data.green, data.blue = colour.T
    return ()


def _intensities(path: Path, data: Any, cloud: FileCloud) -> tuple[str, ...]:
    """Set the intensities; those between 0 and 1 are shares of the full range."""
    values = cloud.intensity
    if values is None:
        return ()
    if not ((values >= 0) & (values <= _FULL)).all():  # NaN is refused, too
        raise DataError(
            f"{path}: an intensity is not within 0 to {_FULL}, as LAS files hold it; write a PLY "
            "or PCD file"
        )
    is_whole = bool((values == np.round(values)).all())
    is_share = not is_whole and float(values.max()) <= 1.0
    wide = values.astype(np.float64)
    data.intensity = np.round(wide * _FULL if is_share else wide).astype(np.uint16)
    if is_share:
        return (f"intensities from 0 to 1 are written from 0 to {_FULL}",)
    return () if is_whole else ("intensities are rounded to whole numbers",)
