"""The steps of registration: keypoints, descriptors, matches, groups, motions, fits, gates."""

import itertools

import numpy as np
import pytest
from executive_plugins.registration.centroid_matching import matched_centroids
from executive_plugins.registration.consistency import consistent_transforms
from executive_plugins.registration.constellation import constellation_transforms
from executive_plugins.registration.eigen import sorted_eigenvectors
from executive_plugins.registration.features import Features, match
from executive_plugins.registration.form import form_error
from executive_plugins.registration.fpfh_features import describe
from executive_plugins.registration.gate import NOTHING, measure
from executive_plugins.registration.iss import salient_points, surface_shapes
from executive_plugins.registration.neighbours import neighbours_within
from executive_plugins.registration.settings import SegmentShotSettings
from executive_plugins.registration.shot import reference_frame, shot_descriptors
from executive_plugins.registration.shot_features import (
    describe_keypoints,
    find_keypoints,
    match_descriptors,
)
from executive_plugins.registration.similarity import Similarity, Surface, refine
from executive_plugins.registration.single_object import _faults, _rotations
from executive_plugins.registration.thinning import thinned

from executive.geometry.pose import pose, transform
from executive.geometry.rotation import exp_so3, from_rpy
from executive.messages.segment import Segment


def grid_points(seed: int, count: int = 120, spread: int = 8) -> np.ndarray:
    return np.random.default_rng(seed).integers(-spread, spread, (count, 3)) / 8.0


def lump(count: int = 700, seed: int = 1) -> np.ndarray:
    d = np.random.default_rng(seed).normal(size=(count, 3))
    d /= np.linalg.norm(d, axis=1)[:, None]
    return d * (0.5 + 0.1 * np.sin(d @ np.array([[3.0, 1], [0, 4], [2, -2]])).sum(1))[:, None]


T = pose(from_rpy(0.03, -0.02, 0.7), np.array([1.0, -2.0, 0.3]))


def test_matched_centroids(recorded) -> None:
    a, b = grid_points(1, 7), grid_points(2, 5)
    told = [matched_centroids(a, b, d) for d in (0.25, 0.5, 1.0, 9.0)]
    square = np.array([[0.0, 0, 0], [1, 0, 0]])
    told += [matched_centroids(square, square + [d, 0, 0], 0.5) for d in (0.25, 0.5)]
    told += [matched_centroids(a[:0], b, 1.0), matched_centroids(a, b[:0], 1.0)]
    recorded(told)


@pytest.mark.parametrize("count", [1, 3, 10])
def test_consistent_transforms(recorded, count) -> None:
    rng, told = np.random.default_rng(3), []
    for scale_error, tolerance_m in itertools.product((0.0, 0.05), (0.02, 0.2)):
        source = rng.uniform(-2, 2, (70, 3))
        target = transform(T, source) + rng.normal(0, 0.01, (70, 3))
        target[30:50] = transform(T @ T, source[30:50]) * 1.02
        target[50:] = rng.uniform(-2, 2, (20, 3))
        told.append(consistent_transforms(target, source, tolerance_m, scale_error, count))
    recorded(
        (told, [consistent_transforms(target[:n], source[:n], 9.0, 0.1, 5) for n in (3, 4, 5)])
    )


def test_groups_at_the_limits(recorded) -> None:
    """Matches whose distances agree exactly up to the tolerance, and a lever at its least."""
    square = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1], [0, 0.25, 0], [0.5, 0, 0]])
    told = []
    for factor, tolerance in itertools.product((1.0, 1.25, 1.5), (0.0, 0.25, 0.5, 1.0)):
        told.append(consistent_transforms(factor * square, square, tolerance, 0.0, 3))
    recorded(told)


@pytest.mark.parametrize("count", [1, 4, 100])
def test_constellations(recorded, count) -> None:
    rng = np.random.default_rng(4)
    source = np.column_stack([rng.uniform(-4, 4, (6, 2)), rng.uniform(0, 0.5, 6)])
    target = transform(T, source[:5]) + rng.normal(0, 0.05, (5, 3))
    normal = T[:3, 2]
    planes = np.append(normal, normal @ T[:3, 3]), np.array([0.0, 0, 1, 0])
    told = [
        constellation_transforms((target, planes[0]), (source, planes[1]), tolerance, vote, count)
        for tolerance, vote in ((0.5, 1.0), (0.1, 0.3), (0.01, 0.02))
    ]
    near = source[:2] * 0.01
    told.append(constellation_transforms((near, planes[1]), (near, planes[1]), 0.5, 1.0, count))
    recorded(told)


def test_pairs_of_a_grid(recorded) -> None:
    """Centroids whose distances tie, and are as far as the tolerance and the least allow."""
    level, told = np.array([0.0, 0, 1, 0.5]), []
    corners = np.array([[0.0, 0, 0.5], [0.8, 0, 0.75], [0, 1.5, 0.5], [2, 2, 1]])
    for tolerance in (0.5, 0.7):
        stars = (corners, level), (corners[:3] + [1, 0, 0], level)
        told.append(constellation_transforms(*stars, tolerance, 1.0, 6))
    recorded(told)


def test_eigenvectors(recorded) -> None:
    told = []
    for A in (*grid_points(5, 24).reshape(-1, 3, 3), np.zeros((3, 3)), np.diag([1.0, 3, 2])):
        told.append(sorted_eigenvectors(A @ A.T))
    told.append(sorted_eigenvectors(np.array([[1.0, 0.5, 0], [0.5, 1, 0], [0, 0, 1.5]])))
    recorded([np.hstack([values, vectors.ravel()]) for values, vectors in told])


def test_neighbours(recorded) -> None:
    points = grid_points(6)
    told = [neighbours_within(points, points[::3], radius) for radius in (0.125, 0.25, 0.5, 3.0)]
    dense = np.repeat(points[:6], 40, axis=0)
    told.append(neighbours_within(dense, dense[::5], 0.5))
    recorded([(starts, rows.tolist()) for starts, rows in told])


@pytest.mark.parametrize("radius_m", [0.2, 0.35, 1.5])
def test_keypoints(recorded, radius_m) -> None:
    told = []
    for points in (lump(200), grid_points(7), np.unique(grid_points(8, 90, 3), axis=0)):
        near = neighbours_within(points, points, radius_m)
        normals, saliencies = surface_shapes(points, *near)
        told.append((normals, saliencies, salient_points(saliencies, *near)))
    tie = np.array([0.5, 0.5, 0.25, 0.0, 0.75])
    starts, rows = np.array([0, 2, 4, 7, 8, 9]), np.array([0, 1, 0, 1, 1, 2, 3, 3, 4])
    told.append(salient_points(tie, starts, rows))
    recorded(told)


@pytest.mark.parametrize("radius_m", [0.3, 0.5, 1.2])
def test_descriptors(recorded, radius_m) -> None:
    told = []
    for points in (lump(300), grid_points(9, 150)):
        normals = points / np.maximum(np.linalg.norm(points, axis=1), 1e-9)[:, None]
        normals[::7] = 0.0
        rows = np.arange(0, len(points), 11)
        near = neighbours_within(points, points[rows], radius_m)
        told.append(shot_descriptors(points, normals, rows, near, radius_m))
        told.append(reference_frame(points, np.arange(30), points[3], normals[3], radius_m))
    lonely = np.vstack([lump(7), [[9.0, 9, 9]]])
    for k in (7, 8):
        near = np.array([0, k]), np.arange(k)
        told.append(shot_descriptors(lonely, lonely, np.array([0]), near, radius_m))
    recorded(told)


def test_one_neighbour_in_each_bin(recorded) -> None:
    """Votes of neighbours in exact directions: on the axes, and on the borders of bins."""
    told = []
    disc = np.array([[2.0, 0, 0], [-2, 0, 0], [0, 1, 0], [0, -1, 0]] * 2) * 0.1
    for offset in itertools.product((-0.5, 0.0, 0.5), repeat=3):
        points = np.vstack([[[0.0, 0, 0]], disc, [offset]])
        normals = np.zeros((10, 3))
        normals[0], normals[9] = [0, 0, 1], np.array([0.6, 0.0, 0.8])
        near = np.array([0, 10]), np.arange(10)
        told.append(shot_descriptors(points, normals, np.array([0]), near, 1.0)[0])
        for axis in np.eye(3):
            normals[9] = axis
            told.append(shot_descriptors(points, normals, np.array([0]), near, 1.0)[0])
    recorded(np.vstack(told))


def test_matches_of_descriptors(recorded) -> None:
    rng = np.random.default_rng(10)
    a, b = (Features(rng.normal(size=(n, 3)), rng.normal(size=(n, 33))) for n in (9, 6))
    twice = Features(np.vstack([a.points, a.points + 1]), np.vstack([a.descriptors] * 2))
    none = Features(np.empty((0, 3)), np.empty((0, 33)))
    told = [
        match(a, b, 2),
        match(twice, b, 3),
        match(b, a, 100),
        match(none, a, 2),
        match(a, none, 2),
    ]
    told += [match_descriptors(a, b, n) for n in (3, 100)]
    told += [
        match_descriptors(twice, b, 4),
        match_descriptors(none, a, 2),
        match_descriptors(a, none, 2),
    ]
    recorded(told)


def test_features_of_a_segment(recorded) -> None:
    points = lump(1500) + [4, 5, 1]
    segment = Segment(0, points, points.mean(axis=0), np.ones(3))
    found = find_keypoints(segment, 0.06, 0.15, 0.1)
    recorded((found, describe_keypoints([found, found], 0.4), describe_keypoints([], 0.4)))


def test_fast_features(recorded) -> None:
    """Of dense lumps, whose neighbourhoods are cut to the most neighbours, and of sparse ones."""
    told = []
    for count, voxel_m in ((3500, 0.025), (300, 0.1)):
        points = lump(count) + [4, 5, 1]
        segments = [
            Segment(i, part, part.mean(axis=0), np.ones(3))
            for i, part in enumerate((points, points * [1, -1, 1] + [2, 0, 0]))
        ]
        told.append(describe(segments, voxel_m, 0.15, 0.4))
    recorded(told, relative=1e-6)  # neighbours are found in another order by other builds


@pytest.mark.parametrize("max_scale_error", [0.0, 0.01, 0.1])
def test_refinement(recorded, max_scale_error) -> None:
    surface, source = Surface.thinned(lump(2500), 0.05), lump(600, 2)
    start = Similarity(pose(exp_so3(np.array([0.05, 0.0, -0.04])), np.array([0.03, 0, 0.02])), 1.0)
    told = []
    for reaches in ((0.3,), (0.3, 0.2, 0.1), (0.002, 0.3), ()):
        fitted = refine(surface, source * 0.96, start, reaches, max_scale_error)
        told.append((fitted, fitted.apply(source[:5])))
    recorded(told)


def test_fewest_pairs(recorded) -> None:
    surface, source = Surface.thinned(lump(2500), 0.05), lump(600, 2)
    start = Similarity(np.eye(4), 1.0)
    recorded([refine(surface, source[:n], start, (0.3,), 0.1) for n in (19, 20, 21)])


def test_surfaces(recorded) -> None:
    surface = Surface.thinned(lump(900), 0.1)
    joined = surface.joined(Surface(np.zeros((1, 3)), np.ones((1, 3))))
    told = joined.nearest(np.array([[0.0, 0, 0.1], [0, 0, 0.9], [0, 0, 3]]), 0.5)
    recorded((surface.points, surface.normals, joined.points, told, thinned(lump(200), 0.2)))


def test_form(recorded) -> None:
    surface = Surface.thinned(lump(2500), 0.05)
    told = [form_error(surface, lump(400, 3) * scale, 0.1) for scale in (0.9, 1.0, 1.05)]
    told.append(form_error(surface, lump(50, 3) + 5.0, 0.1))
    recorded(told)


def test_agreement(recorded) -> None:
    whole, told = lump(2000), []
    for part in (whole[whole[:, 2] > 0], whole * 1.1, whole + [0.2, 0, 0], whole[:1] + 9):
        found = measure(whole, part, 0.1, 0.05)
        both = found + measure(part, whole, 0.1, 0.05)
        told += [(found, found.better, str(found), found.source.share, found.source.rmse_m)]
        told += [(both, both.better, both.target.share, both.target.rmse_m)]
    recorded((told, NOTHING.better, NOTHING.source.share, NOTHING.source.rmse_m))


def test_rotations(recorded) -> None:
    recorded(np.array(list(_rotations(40))))


def test_faults_of_an_object(recorded) -> None:
    told = []
    view = measure(lump(900), lump(900), 0.1, 0.05)
    far = measure(lump(900), lump(900)[:200] * 3, 0.1, 0.05)
    for form, sunk, rival in ((0.0, 0.0, 9.0), (0.011, 0.05, 1.25), (0.0111, 0.06, 1.2)):
        told += [_faults(found, form, sunk, rival) for found in (view, far)]
    recorded(told)


def test_presets(recorded) -> None:
    told = [SegmentShotSettings(**given) for given in ({}, {"preset": "paper"}, {"preset": "sure"},
            {"preset": "paper", "iss_radius_m": 0.09})]  # fmt: skip
    recorded(told)
