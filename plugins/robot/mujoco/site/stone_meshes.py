"""Stones from a folder of scans: OBJ, PLY or STL in metres, times a scale."""

from pathlib import Path

import numpy as np
import open3d as o3d
from executive_plugins.robot.mujoco.site.mass_properties import volume_and_centroid
from executive_plugins.robot.mujoco.site.ray_mesh import Mesh

from executive.arrays import Float
from executive.errors import ConfigError

_SUFFIXES = (".obj", ".ply", ".stl")
_EXTENT_M = (0.1, 5.0)  # plausible extents of a stone; others indicate a wrong unit
_SETTING = "robot.site.stones"


def mesh_files(folder: Path) -> tuple[Path, ...]:
    """List the meshes of a folder by name.

    Raises:
        ConfigError: If it is not a folder or holds no mesh.
    """
    if not folder.is_dir():
        raise ConfigError(
            f"{_SETTING}.folder: '{folder}' is not a folder; give one with OBJ, PLY or STL meshes"
        )
    files = tuple(sorted(path for path in folder.iterdir() if path.suffix.lower() in _SUFFIXES))
    if not files:
        raise ConfigError(f"{_SETTING}.folder: '{folder}' holds no mesh ({', '.join(_SUFFIXES)})")
    return files


def read_skin(path: Path, scale: float) -> Mesh:
    """Read a closed mesh, scale it, and turn its triangles outwards.

    Raises:
        ConfigError: If it cannot be read, is not closed, or has an implausible size; the message
            names the file and the cure.
    """
    with o3d.utility.VerbosityContextManager(o3d.utility.VerbosityLevel.Error):
        mesh = o3d.io.read_triangle_mesh(path)
    mesh.remove_duplicated_vertices()  # STL files repeat each vertex in each triangle
    mesh.remove_degenerate_triangles()
    vertices, triangles = (
        np.asarray(mesh.vertices) * scale,
        np.asarray(mesh.triangles).astype(np.int64),
    )
    if not len(triangles) or not np.isfinite(vertices).all():
        raise ConfigError(
            f"{path}: not a readable mesh; export it again as OBJ, PLY or STL, or remove it from "
            "the folder"
        )
    _check_size(path, vertices, scale)
    if not (mesh.is_watertight() and mesh.orient_triangles()):
        raise ConfigError(
            f"{path}: the mesh is not closed, so it has no volume; fill its holes, or remove it"
        )
    triangles = np.asarray(mesh.triangles).astype(np.int64)
    volume_m3, _ = volume_and_centroid(vertices, triangles)
    return vertices, triangles if volume_m3 > 0 else triangles[:, ::-1]


def _check_size(path: Path, vertices: Float, scale: float) -> None:
    extent_m = float(np.ptp(vertices, axis=0).max())
    least, most = _EXTENT_M
    if not least <= extent_m <= most:
        raise ConfigError(
            f"{path}: {extent_m:.3g} m across at scale {scale:g}, allowed is {least} to {most} m; "
            f"meshes are in metres: set {_SETTING}.scale"
        )
