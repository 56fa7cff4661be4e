"""Point clouds from PLY, PCD and XYZ files, read strictly: a file that is cut short is refused, not padded.

Open3D warns of a truncated file on the terminal and returns rubbish; here the header is held against the file first.
"""

from pathlib import Path

import numpy as np
import open3d as o3d

from executive.arrays import Float
from executive.clouds.pcd_header import check_pcd
from executive.clouds.ply_header import check_ply
from executive.errors import DataError

_CHECKS = {".ply": check_ply, ".pcd": check_pcd, ".xyz": None}
_SITE_M = (0.5, 500.0)
_UNITS = {"millimetres": 0.001, "centimetres": 0.01}  # that sites were seen in, the likelier first
_FARTHEST_M = 1e7  # national grids end before; beyond, a float has no centimetres left


def read_points(path: Path) -> Float:
    """Return the points of a file, shape (N, 3) [m].

    Raises:
        DataError: If it is missing, of another kind, cut short, empty, or holds absurd coordinates.
    """
    if not path.is_file():
        raise DataError(f"{path}: no such file; give the path of a PLY, PCD or XYZ cloud")
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


def read_site(path: Path) -> Float:
    """Return the points of a file that holds a site in metres, shape (N, 3) [m].

    Raises:
        DataError: As `read_points`; or if the cloud is too small or too wide for a site, which is often another unit.
    """
    points = read_points(path)
    extent = float(np.ptp(points, axis=0).max())
    least_m, most_m = _SITE_M
    if extent > most_m:
        guess = next((f for f in _UNITS if least_m <= extent * _UNITS[f] <= most_m), "")
        unit = (
            f"in {guess} it would be {extent * _UNITS[guess]:.3g} m: scale it by {_UNITS[guess]}"
            if guess
            else "crop it"
        )
        raise DataError(f"{path}: {extent:.6g} across is no site in metres (at most {most_m:g} m); {unit}")
    if extent < least_m:
        raise DataError(f"{path}: {extent:.3g} m across is no site (at least {least_m:g} m); is its unit the metre?")
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
