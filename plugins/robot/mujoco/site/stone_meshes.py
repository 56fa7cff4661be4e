"""Stones from a folder of scans: OBJ, PLY or STL in metres, times a scale."""

from pathlib import Path

import numpy as np
import open3d as o3d
from executive_plugins.robot.mujoco.site.ray_mesh import Mesh

from executive.arrays import Float
from executive.clouds.meshes.reader import SUFFIXES, read_mesh
from executive.errors import ConfigError, DataError
from executive.geometry.solid import volume_and_centroid

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
    files = tuple(sorted(path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES))
    if not files:
        raise ConfigError(f"{_SETTING}.folder: '{folder}' holds no mesh ({', '.join(SUFFIXES)})")
    return files


def read_skin(path: Path, scale: float) -> Mesh:
    """Read a closed mesh, scale it, and turn its triangles outwards.

    Raises:
        ConfigError: If it cannot be read, is not closed, or has an implausible size; the message
            names the file and the cure.
    """
    try:
        corners, triangles = read_mesh(path)
    except DataError as error:
        raise ConfigError(str(error)) from error
    vertices = corners * scale
    _check_size(path, vertices, scale)
    mesh = o3d.geometry.TriangleMesh(
        o3d.utility.Vector3dVector(corners), o3d.utility.Vector3iVector(triangles)
    )
    if not (_is_closed(mesh) and mesh.orient_triangles()):
        raise ConfigError(
            f"{path}: the mesh is not closed, so it has no volume; fill its holes, or remove it"
        )
    triangles = np.asarray(mesh.triangles).astype(np.int64)
    volume_m3, _ = volume_and_centroid(vertices, triangles)
    return vertices, triangles if volume_m3 > 0 else triangles[:, ::-1]


def _is_closed(mesh: o3d.geometry.TriangleMesh) -> bool:
    """Return whether each edge belongs to two triangles, and each vertex to one fan of them.

    Open3D's `is_watertight` also compares each triangle with each other one: 16 s for 40,000. A
    mesh that penetrates itself is therefore accepted; what overlaps counts twice in its volume.
    """
    return bool(mesh.is_edge_manifold(allow_boundary_edges=False) and mesh.is_vertex_manifold())


def _check_size(path: Path, vertices: Float, scale: float) -> None:
    extent_m = float(np.ptp(vertices, axis=0).max())
    least, most = _EXTENT_M
    if not least <= extent_m <= most:
        raise ConfigError(
            f"{path}: {extent_m:.3g} m across at scale {scale:g}, allowed is {least} to {most} m; "
            f"meshes are in metres: set {_SETTING}.scale"
        )
