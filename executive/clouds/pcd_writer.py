"""Point clouds as binary PCD files."""

from pathlib import Path

import numpy as np

from executive.clouds.file_cloud import FileCloud


def write_pcd(path: Path, cloud: FileCloud) -> tuple[str, ...]:
    """Write a cloud as binary PCD 0.7 and return what is changed.

    Coordinates are in single precision where that changes none of them, as the Point Cloud Library
    expects them, else in double precision. The coordinate system is a comment, `# crs NAME`.
    """
    # An overflow makes a coordinate infinite, which equals none: it is written as a double.
    with np.errstate(over="ignore"):
        is_single = np.array_equal(cloud.points, cloud.points.astype(np.float32))
    size = 4 if is_single else 8
    kinds = [(axis, f"<f{size}") for axis in "xyz"]
    if cloud.colour is not None:
        kinds.append(("rgb", "<u4"))
    if cloud.intensity is not None:
        kinds.append(("intensity", "<f4"))
    rows = np.empty(len(cloud), kinds)
    for column, axis in enumerate("xyz"):
        rows[axis] = cloud.points[:, column]
    if cloud.colour is not None:
        red, green, blue = cloud.colour_8().astype(np.uint32).T
        rows["rgb"] = red << 16 | green << 8 | blue
    if cloud.intensity is not None:
        rows["intensity"] = cloud.intensity
    path.write_bytes(_header(cloud, rows).encode("ascii") + rows.tobytes())
    return cloud.rounding_to_8()


def _header(cloud: FileCloud, rows: np.ndarray) -> str:
    names = rows.dtype.names or ()
    kinds = [rows.dtype[name] for name in names]
    crs = [f"# crs {cloud.place.crs}"] if cloud.place.crs else []
    lines = [
        "# .PCD v0.7 - Point Cloud Data file format",
        *crs,
        "VERSION 0.7",
        f"FIELDS {' '.join(names)}",
        f"SIZE {' '.join(str(kind.itemsize) for kind in kinds)}",
        f"TYPE {' '.join(kind.kind.upper() for kind in kinds)}",
        f"COUNT {' '.join('1' for _ in names)}",
        f"WIDTH {len(rows)}",
        "HEIGHT 1",
        "VIEWPOINT 0 0 0 1 0 0 0",
        f"POINTS {len(rows)}",
        "DATA binary",
        "",
    ]
    return "\n".join(lines)
