"""Geometry at exact turns, ties and borders of cells."""

import itertools

import numpy as np
import pytest

from executive.errors import DataError
from executive.geometry import convex, geodesy, rotation
from executive.geometry.gap import gap_below
from executive.geometry.pose import adjoint, interpolate, inverse, pose, pose_xyz_rpy, transform
from executive.geometry.rigid_fit import rigid_fit, similarity_fit
from executive.geometry.voxels import first_in_cells, voxel_means

VECTORS = [
    scale * np.array(v, dtype=float)
    for scale in (0.0, 1e-13, 5e-9, 2e-8, 1e-3, 1.0, np.pi / 2, np.pi, 3.0)
    for v in ((1, 0, 0), (0, 1, 0), (0, 0, -1), (0.6, 0.0, 0.8), (-0.48, 0.6, 0.64))
]


def grid(seed: int, count: int = 60) -> np.ndarray:
    return np.random.default_rng(seed).integers(-8, 9, (count, 3)) / 8.0


def test_rotations(recorded) -> None:
    told = []
    for v in VECTORS:
        R = rotation.exp_so3(v)
        told.append((R - np.eye(3), rotation.log_so3(R), rotation.quaternion_wxyz(R)))
        told.append((rotation.skew(v), rotation.yaw_of(R), rotation.angle_between(R, R @ R)))
    told += [
        rotation.from_quaternion(q + 0.1) for q in np.random.default_rng(1).normal(size=(5, 4))
    ]
    told += [rotation.from_rpy(*v) for v in VECTORS[-9:]]
    told += [rotation.wrap_angle(a) for a in (0.0, np.pi, -np.pi, 4.0, -4.0, 7.0, 100.0)]
    told += [rotation.about_axis((0, 0.6, 0.8), a) for a in (0.0, 1.0, -2.0)]
    recorded(told)


def test_poses(recorded) -> None:
    a, b = (pose(rotation.exp_so3(VECTORS[k]), VECTORS[k - 1]) for k in (29, 34))
    told = [interpolate(a, b, f) for f in (0.0, 0.25, 1.0, 1.5)]
    told += [inverse(a), adjoint(a), transform(b, grid(2)), transform(b, VECTORS[30])]
    told += [pose(), pose(a[:3, :3]), pose(t=VECTORS[20]), pose_xyz_rpy((1, 2, 3), (0.1, 0.2, 0.3))]
    recorded(told)


def test_fits(recorded) -> None:
    told, source = [], grid(3, 9)
    T = pose(rotation.exp_so3(VECTORS[29]), np.array([1.0, 2, 3]))
    for target in (transform(T, source), 2 * transform(T, source), source * [1, 1, -1], grid(4, 9)):
        told += [rigid_fit(target, source), similarity_fit(target, source)]
    told.append(similarity_fit(source, np.ones((9, 3)))[0])
    recorded(told)


def test_hulls(recorded) -> None:
    told = []
    for points in (grid(5), np.array(list(itertools.product((0.0, 1.0), repeat=3)))):
        faces = convex.half_spaces(points)
        told += [faces, convex.depth_inside(faces, grid(6)), convex.volume_and_centroid(points)]
        told.append(convex.convex_corners(points))
    for flat in (np.zeros((5, 3)), grid(7)[:3], grid(7) * [1, 1, 0]):
        with pytest.raises(DataError) as refused:
            convex.half_spaces(flat)
        told.append(refused.value)
    recorded(told)


def test_gaps(recorded) -> None:
    told, stone = [], grid(8) + (0, 0, 2)
    for shift in (0.0, 1.0, 1.5, 2.0, 2.25, 2.5, 2.75, 3.5):
        for height in (-0.5, 0.5, 3.0):
            told.append(gap_below(stone, grid(9)[:5] + (shift, 0, height)))
    recorded(told)


def test_geodesy(recorded) -> None:
    told = []
    for datum in (
        (47.4, 8.5, 440.0),
        (-33.0, -70.5, -10.0),
        (0.0, 0.0, 0.0),
        (89.0, 179.9, 9000.0),
    ):
        for enu in ((0.0, 0, 0), (100.0, -200, 30), (-5e4, 8e4, 1e3)):
            geodetic = geodesy.geodetic_from_enu(np.array(enu), np.array(datum))
            told += [geodetic, geodesy.enu_from_geodetic(geodetic, np.array(datum))]
            told.append(geodesy.ecef(*geodetic))
    # Coordinates of the earth's radius lose nine digits to metres.
    recorded(told, absolute=1e-7)


def test_cells(recorded) -> None:
    points, told = grid(10, 90), []
    for size_m in (0.125, 0.25, 0.3, 5.0):
        told += [voxel_means(points, size_m), voxel_means(points, size_m, np.full(3, 0.0625))]
        told += [first_in_cells(points, size_m), first_in_cells(points[:, :2], size_m)]
    recorded((told, voxel_means(points[:0], 1.0)))
