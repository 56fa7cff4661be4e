"""Points from LAS and LAZ files; they are read in a process with limits of memory and time."""

from pathlib import Path

from executive.arrays import Float
from executive.clouds.las_header import check_sizes
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
    require_extra(f"{path}: a LAS or LAZ file", "las")
    check_sizes(path)
    (points,) = read_confined("executive.clouds.las_points:las_points", path)
    return points
