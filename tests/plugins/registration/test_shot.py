"""SHOT: the same under any motion, different at different places."""

import numpy as np
import pytest
from executive_plugins.registration.features import Features
from executive_plugins.registration.iss import surface_shapes
from executive_plugins.registration.neighbours import neighbours_within
from executive_plugins.registration.shot import SHOT_LENGTH, reference_frame, shot_descriptors
from executive_plugins.registration.shot_features import match_descriptors

from executive.geometry.rotation import from_rpy


def lump() -> np.ndarray:
    rng = np.random.default_rng(4)
    d = rng.normal(size=(2500, 3))
    d /= np.linalg.norm(d, axis=1)[:, None]
    waves = rng.normal(0, 2.5, (3, 3))
    return d * (0.6 * (1 + 0.15 * np.sin(d @ waves).sum(axis=1)))[:, None] * [1.0, 0.8, 0.6]


def described(points: np.ndarray, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    normals, _ = surface_shapes(points, *neighbours_within(points, points, 0.12))
    return shot_descriptors(
        points, normals, rows, neighbours_within(points, points[rows], 0.4), 0.4
    )


@pytest.mark.parametrize("rpy", [(0.3, 0.2, -2.0), (3.0, -1.0, 0.5)])
def test_a_motion_turns_frames_and_leaves_descriptors(rpy: tuple[float, float, float]) -> None:
    points, rows, R = lump(), np.arange(0, 2500, 50), from_rpy(*rpy)
    before, frames = described(points, rows)
    after, turned = described(points @ R.T + [3.0, -2.0, 1.0], rows)
    same = np.abs(after - before).max(axis=1) < 1e-6
    assert (
        same.mean() >= 0.96
    )  # where as many points lie ahead as behind, rounding decides the sign of x
    np.testing.assert_allclose(turned[same], (frames @ R.T)[same], atol=1e-6)


def test_descriptors_are_of_unit_length_and_frames_right_handed() -> None:
    found, frames = described(lump(), np.arange(0, 2500, 100))
    assert found.shape == (25, SHOT_LENGTH)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1.0)
    np.testing.assert_allclose(np.linalg.det(frames), 1.0)


def test_the_frame_of_a_plane_has_its_normal() -> None:
    axis = np.arange(-0.3, 0.3, 0.04)
    plane = np.array(np.meshgrid(axis, axis, [0.0])).reshape(3, -1).T
    down = np.array([0.0, 0.0, -1.0])
    frame = reference_frame(plane, np.arange(len(plane)), np.zeros(3), down, 0.5)
    np.testing.assert_allclose(frame[2], down, atol=1e-12)


def test_a_lonely_keypoint_is_not_described() -> None:
    points = np.vstack([lump(), [[5.0, 5.0, 5.0]]])
    found, _ = described(points, np.array([2500]))
    assert not found.any()


def test_each_place_is_matched_with_itself() -> None:
    points, rows, R = lump(), np.arange(0, 2500, 40), from_rpy(0.1, 0.4, 1.0)
    there = Features(points[rows], described(points, rows)[0])
    here = Features(points[rows] @ R.T, described(points @ R.T, rows)[0])
    target, source = match_descriptors(there, here, 1000)
    np.testing.assert_allclose(source, target @ R.T)
    assert len(target) == len(rows)
    assert len(match_descriptors(there, here, 5)[0]) == 5


def test_nothing_matches_with_nothing() -> None:
    nothing = Features(np.empty((0, 3)), np.empty((0, SHOT_LENGTH)))
    target, source = match_descriptors(nothing, nothing, 10)
    assert target.shape == source.shape == (0, 3)
