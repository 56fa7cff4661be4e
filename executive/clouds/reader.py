"""Point clouds from files of any supported format; a truncated file is refused.

Common libraries only print a warning for a truncated file and return wrong points. Files are read
piece by piece into one array of double precision, so that little memory is needed besides.
"""

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from executive.arrays import Float
from executive.clouds.coordinate_system import coordinate_system
from executive.clouds.e57 import read_e57, read_e57_cloud
from executive.clouds.file_cloud import FileCloud
from executive.clouds.las import read_las, read_las_cloud
from executive.clouds.pcd import read_pcd, read_pcd_cloud
from executive.clouds.ply import read_ply, read_ply_cloud
from executive.clouds.units import check_site
from executive.clouds.xyz import read_xyz, read_xyz_cloud
from executive.errors import DataError

T = TypeVar("T")
_READERS: dict[str, Callable[[Path], Float]] = {
    ".ply": read_ply, ".pcd": read_pcd, ".las": read_las, ".laz": read_las,
    ".e57": read_e57,
    ".xyz": read_xyz, ".txt": read_xyz, ".asc": read_xyz, ".csv": read_xyz, ".pts": read_xyz,
}  # fmt: skip
_CLOUD_READERS: dict[Callable[[Path], Float], Callable[[Path], FileCloud]] = {
    read_ply: read_ply_cloud,
    read_pcd: read_pcd_cloud,
    read_las: read_las_cloud,
    read_e57: read_e57_cloud,
    read_xyz: read_xyz_cloud,
}
SUFFIXES = tuple(_READERS)
_BEGINNINGS = {
    b"ply\n": ".ply",
    b"ply\r": ".ply",
    b"# .PCD": ".pcd",
    b"LASF": ".las",
    b"ASTM-E57": ".e57",
}
_PACKED = {b"\x1f\x8b": "gzip", b"PK\x03\x04": "zip", b"7z\xbc\xaf": "7-zip"}
_FARTHEST_M = 1e7  # coordinates of national grids are smaller


def read_points(path: Path) -> Float:
    """Return the points of a file [m], shape (N, 3), each once, in the file's order.

    Points with coordinates that are not finite are left out and counted in the log: see
    `PointCollector`.

    Raises:
        DataError: If the file is missing, of another format, cut short or empty, or a coordinate is
            beyond 10,000 km.
    """
    points = _read(path, _reader)
    _check_range(path, points)
    return points


def read_cloud(path: Path) -> FileCloud:
    """Return the points of a file as `read_points` does, with what it says of them.

    Raises:
        DataError: As `read_points`; or if a colour is beyond its range.
    """
    cloud = _read(path, lambda one: _CLOUD_READERS[_reader(one)])
    _check_range(path, cloud.points)
    return replace(cloud, place=replace(cloud.place, crs=coordinate_system(path)))


def _read(path: Path, choose: Callable[[Path], Callable[[Path], T]]) -> T:
    if not os.path.isfile(path):  # that of a Path raises for a name that is too long
        raise DataError(f"{path}: no such file; give the path of a cloud: {', '.join(_READERS)}")
    try:
        return choose(path)(path)
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror or error}") from error


def _check_range(path: Path, points: Float) -> None:
    farthest = float(max(abs(points.min()), abs(points.max())))
    if farthest > _FARTHEST_M:
        raise DataError(
            f"{path}: a coordinate of {farthest:.3g} m is beyond {_FARTHEST_M:.0e} m; "
            "coordinates are in metres: scale or shift the cloud, or export it again "
            "if they are nonsense"
        )


def read_site(path: Path, widest_m: float | None = None) -> Float:
    """Return the points of a file that holds a site [m], shape (N, 3).

    Args:
        path: The file.
        widest_m: Largest width of a site [m]; None for the usual one.

    Raises:
        DataError: As `read_points`; or if the cloud is too small, too wide or too coarse for a site
            in metres, which often means that its unit is another one.
    """
    points = read_points(path)
    check_site(path, points, widest_m)
    return points


def _reader(path: Path) -> Callable[[Path], Float]:
    """Return the reader for the file's first bytes or, if they tell nothing, for its suffix."""
    with path.open("rb") as file:
        beginning = file.read(8)
    for magic, packer in _PACKED.items():
        if beginning.startswith(magic):
            raise DataError(f"{path}: is compressed by {packer}; unpack it first")
    for magic, suffix in _BEGINNINGS.items():
        if beginning.startswith(magic):
            return _READERS[suffix]
    suffix = path.suffix.lower()
    if suffix not in _READERS:
        raise DataError(
            f"{path}: not a supported cloud format; convert it to {', '.join(_READERS)}"
        )
    return _READERS[suffix]
