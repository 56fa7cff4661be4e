"""Matches of a pair against a submap, where the truth is known."""

from collections.abc import Callable

import numpy as np
import pytest
from executive_plugins.mapping.scan_matching import ScanMatcher
from executive_plugins.mapping.settings import ScanMatchingSettings

from executive.geometry.pose import pose
from executive.geometry.rotation import angle_between, exp_so3

STEP = pose(exp_so3(np.array([0.0, 0.0, 0.02])), np.array([0.02, 0.01, 0.0]))


def corner(rng: np.random.Generator, noise_m: float = 0.01, walls: bool = True) -> np.ndarray:
    """Ground and two walls, 5,000 points."""
    ground = np.column_stack([rng.uniform(-5, 5, (3000, 2)), np.full(3000, -1.5)])
    one = np.column_stack(
        [np.full(1000, 5.0), rng.uniform(-5, 5, 1000), rng.uniform(-1.5, 1, 1000)]
    )
    other = np.column_stack(
        [rng.uniform(-5, 5, 1000), np.full(1000, 5.0), rng.uniform(-1.5, 1, 1000)]
    )
    points = np.vstack([ground, one, other]) if walls else ground
    return points + rng.normal(0, noise_m, points.shape)


def seen_from(T: np.ndarray, points: np.ndarray) -> np.ndarray:
    return ((points - T[:3, 3]) @ T[:3, :3]).astype(np.float32)


@pytest.fixture
def make_matcher() -> Callable[..., tuple[ScanMatcher, list[np.ndarray]]]:
    def make(walls: bool = True, **settings: float) -> tuple[ScanMatcher, list[np.ndarray]]:
        matcher, rng, poses = (
            ScanMatcher(ScanMatchingSettings(**settings)),
            np.random.default_rng(0),
            [np.eye(4)],
        )
        for k in range(10):
            matcher.add(k, seen_from(poses[-1], corner(rng, walls=walls)))
            poses.append(poses[-1] @ STEP)
        return matcher, poses

    return make


def test_the_motion_since_the_previous_node_is_found(make_matcher: Callable) -> None:
    matcher, poses = make_matcher()
    wrong = poses[10] @ pose(
        exp_so3(np.array([0.005, -0.004, 0.008])), np.array([0.05, -0.04, 0.03])
    )
    match = matcher.match(
        seen_from(poses[10], corner(np.random.default_rng(1))), wrong, poses.__getitem__
    )
    assert match is not None
    assert np.linalg.norm(match.T[:3, 3] - STEP[:3, 3]) < 0.004
    assert angle_between(match.T[:3, :3], STEP[:3, :3]) < 0.001


def test_open_ground_constrains_height_and_tilt_only_by_its_covariance(
    make_matcher: Callable,
) -> None:
    matcher, poses = make_matcher(walls=False, max_shift_m=10.0, max_turn_rad=1.0)
    match = matcher.match(
        seen_from(poses[10], corner(np.random.default_rng(1), walls=False)),
        poses[10],
        poses.__getitem__,
    )
    assert match is not None
    std = np.sqrt(np.diag(match.covariance))
    assert std[3:5].min() > 5 * std[5]
    assert std[2] > 5 * std[:2].max()


def test_matches_far_from_odometry_or_with_few_inliers_are_refused(
    make_matcher: Callable,
) -> None:
    matcher, poses = make_matcher(max_shift_m=0.03)
    seen = seen_from(poses[10], corner(np.random.default_rng(1)))
    assert (
        matcher.match(seen, poses[10] @ pose(t=np.array([0.06, 0.0, 0.0])), poses.__getitem__)
        is None
    )
    assert matcher.match(seen, poses[10], poses.__getitem__) is not None
    elsewhere = seen + np.array([0.0, 0.0, 1.0], dtype=np.float32)
    assert matcher.match(elsewhere, poses[10], poses.__getitem__) is None


def test_the_first_pair_has_no_match() -> None:
    matcher = ScanMatcher(ScanMatchingSettings())
    assert (
        matcher.match(
            corner(np.random.default_rng(0)).astype(np.float32), np.eye(4), lambda node: np.eye(4)
        )
        is None
    )


@pytest.mark.parametrize("count", [1, 2])
def test_a_pair_of_too_few_returns_for_a_pose_has_no_match(count: int) -> None:
    """The Hessian has no inverse, though rounding may leave its least eigenvalue above zero."""
    rng = np.random.default_rng(0)
    for _ in range(40):
        matcher = ScanMatcher(ScanMatchingSettings())
        lone = rng.uniform(-9, 9, (count, 3)).astype(np.float32)
        matcher.add(0, lone)
        assert matcher.match(lone, np.eye(4), lambda node: np.eye(4)) is None
