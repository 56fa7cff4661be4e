"""Point clouds from PLY, PCD and XYZ files, read strictly: a file that is cut short is refused, not padded.

Open3D warns of a truncated file on the terminal and returns rubbish; here the header is held against the file first.
"""

from pathlib import Path

import numpy as np
import open3d as o3d

from executive.arrays import Float
from executive.errors import DataError
from plugins.surveying.pcd_header import check_pcd
from plugins.surveying.ply_header import check_ply

_CHECKS = {".ply": check_ply, ".pcd": check_pcd, ".xyz": None}
_FARTHEST_M = 1e7  # national grids end before; beyond, a float has no centimetres left


def read_points(path: Path) -> Float:
    """Return the points of a file, shape (N, 3) [m].

    Raises:
        DataError: If it is missing, of another kind, cut short, empty, or holds absurd coordinates.
    """
    if not path.is_file():
        raise DataError(f"{path}: no such file; give surveying.path of a PLY, PCD or XYZ cloud")
    suffix = path.suffix.lower()
    if suffix not in _CHECKS:
        raise DataError(f"{path}: not a kind of cloud that can be read; convert it to {', '.join(_CHECKS)}")
    check = _CHECKS[suffix]
    if check is None:
        points = _read_xyz(path)
    else:
        check(path)
        with o3d.utility.VerbosityContextManager(o3d.utility.VerbosityLevel.Error):
            points = np.asarray(o3d.io.read_point_cloud(path, remove_nan_points=False).points)
    _check_points(path, points)
    return points


def _read_xyz(path: Path) -> Float:
    """Read lines of x y z and whatever follows; blank lines and # comments are skipped."""
    rows = []
    with path.open(encoding="utf-8", errors="replace") as lines:
        for number, line in enumerate(lines, start=1):
            words = line.split("#")[0].replace(",", " ").split()
            if not words:
                continue
            try:
                x, y, z = map(float, words[:3])
            except ValueError:
                raise DataError(
                    f"{path}:{number}: expected x y z, got '{line.strip()[:40]}'; repair the line"
                ) from None
            rows.append((x, y, z))
    return np.array(rows, dtype=float).reshape(-1, 3)


def _check_points(path: Path, points: Float) -> None:
    if not len(points):
        raise DataError(f"{path}: holds no points; export the cloud again")
    bad = ~np.isfinite(points).all(axis=1)
    if bad.any():
        raise DataError(
            f"{path}: {int(bad.sum())} of {len(points)} points are not finite (the first is number {int(bad.argmax())})"
            "; remove them and export the cloud again"
        )
    if np.abs(points).max() > _FARTHEST_M:
        raise DataError(
            f"{path}: a coordinate of {np.abs(points).max():.3g} m is beyond {_FARTHEST_M:.0e} m; "
            "coordinates are in metres: scale or shift the cloud"
        )
