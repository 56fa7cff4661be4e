"""Clouds into files, with colour, intensity and coordinate system, in the format of their names."""

from collections.abc import Callable
from pathlib import Path

from executive.clouds.coordinate_system import checked_name
from executive.clouds.e57_writer import write_e57
from executive.clouds.file_cloud import FileCloud
from executive.clouds.las_writer import write_las
from executive.clouds.pcd_writer import write_pcd
from executive.clouds.ply_writer import write_ply_cloud

_WRITERS: dict[str, Callable[[Path, FileCloud], tuple[str, ...]]] = {
    ".ply": write_ply_cloud, ".pcd": write_pcd, ".las": write_las, ".laz": write_las,
    ".e57": write_e57,
}  # fmt: skip
WRITTEN = tuple(_WRITERS)


def write_cloud(path: Path, cloud: FileCloud) -> tuple[str, ...]:
    """Write a cloud and return what of it the format does not hold, or holds changed.

    Args:
        path: PLY, PCD, LAS, LAZ or E57 file, by its name.
        cloud: The cloud; it holds a point at least.

    Raises:
        DataError: If the format cannot hold it; the message says which one can.
        MissingExtraError: If the packages that write it are not installed.
    """
    checked_name(path, cloud.place.crs)
    return _WRITERS[path.suffix.lower()](path, cloud)
