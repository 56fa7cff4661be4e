"""Points from LAS and LAZ files; they are read in a process with limits of memory and time."""

from dataclasses import replace
from pathlib import Path

from executive.arrays import Float
from executive.clouds.file_cloud import FileCloud, Place
from executive.clouds.las_header import check_sizes, projection_records
from executive.confined.client import read_confined
from executive.extras import require_extra


def read_las(path: Path) -> Float:
    """Return the points of a LAS or LAZ file [m], shape (N, 3).

    Points of all returns and of all classes are read.

    Raises:
        MissingExtraError: If the packages that read it are not installed.
        DataError: If it is cut short or damaged, its coordinate system is not in metres, or it asks
            for more memory or time than its size explains.
    """
    _check(path)
    (points,) = read_confined("executive.clouds.las_points:las_points", path)
    return points


def read_las_cloud(path: Path) -> FileCloud:
    """Return the points of a LAS or LAZ file, their colour and intensity, and where they are.

    A colour or an intensity that is 0 everywhere was not measured, and is None.

    Raises:
        MissingExtraError: As `read_las`.
        DataError: As `read_las`.
    """
    _check(path)
    read = read_confined("executive.clouds.las_points:las_cloud", path)
    points, colour, intensity, scales, offsets = read
    place = Place("", projection_records(path), tuple(scales.tolist()), tuple(offsets.tolist()))
    cloud = FileCloud(
        points,
        colour if colour.any() else None,
        intensity if intensity.any() else None,
        left_out=("returns, classes, time and the other fields of its points",),
    )
    return replace(cloud, place=place)


def _check(path: Path) -> None:
    require_extra(f"{path}: a LAS or LAZ file", "las")
    check_sizes(path)
