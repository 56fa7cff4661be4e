"""Stones on rough ground."""

import numpy as np
import pytest
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings
from scipy.spatial import cKDTree

from executive.errors import DataError
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import from_rpy
from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud
from executive.messages.segment import PartKind

SPOTS = np.array([[3.0, 0.0], [4.5, 2.5], [0.0, 5.0], [-4.0, 1.0], [5.0, -3.0]])


def heights(xy: np.ndarray) -> np.ndarray:
    return 0.05 * np.sin(1.1 * xy[:, 0]) + 0.05 * np.cos(0.8 * xy[:, 1] + 1)


def stone(spot: np.ndarray, radius_m: float, rng: np.random.Generator) -> np.ndarray:
    """The upper part of an ellipsoid, a third of it in the ground."""
    directions = rng.normal(size=(4000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    points = directions * [radius_m, 0.8 * radius_m, 0.6 * radius_m]
    points[:, 2] += 0.35 * radius_m
    return points[points[:, 2] > 0] + [*spot, heights(spot[None])[0]]


def site(seed: int = 0, half_m: float = 10.0, count: int = 40_000) -> np.ndarray:
    rng = np.random.default_rng(seed)
    xy = rng.uniform(-half_m, half_m, (count, 2))
    xy = xy[(np.linalg.norm(xy[:, None] - SPOTS, axis=2) > 0.5).all(axis=1)]
    ground = np.column_stack([xy, heights(xy)])
    stones = [stone(spot, 0.45 + 0.06 * i, rng) for i, spot in enumerate(SPOTS)]
    points = np.vstack([ground, *stones])
    return points + rng.normal(0, 0.01, points.shape)


def segmenter(**settings: float) -> GroundAndClusters:
    return GroundAndClusters(GroundAndClustersSettings(**settings))


def test_each_stone_is_one_segment_where_it_stands() -> None:
    found = segmenter().segment(Cloud("map", site())).segments
    assert len(found) == len(SPOTS)
    distances = np.linalg.norm(SPOTS[:, None] - np.array([s.centroid[:2] for s in found]), axis=2)
    assert distances.min(axis=1).max() < 0.05
    assert [s.id for s in found] == list(range(len(SPOTS)))
    sizes = [len(s.points) for s in found]
    assert sizes == sorted(sizes, reverse=True)


def test_a_foot_is_what_is_low_beside_a_stone_and_above_the_ground() -> None:
    settings = GroundAndClustersSettings()
    for one in segmenter().segment(Cloud("map", site())).segments:
        assert len(one.foot) > 50
        above = one.foot[:, 2] - heights(one.foot[:, :2])
        assert above.min() > settings.foot_level_m - 0.03  # the ground is not known better
        assert above.max() < settings.plane_margin_m + 0.03
        assert cKDTree(one.points).query(one.foot)[0].max() <= settings.foot_reach_m
        whole = one.with_foot()
        assert len(whole.points) == len(one.points) + len(one.foot)
        np.testing.assert_allclose(whole.centroid, whole.points.mean(axis=0))
        assert not len(whole.foot)


def test_feet_are_left_out_on_request() -> None:
    found = segmenter(foot_reach_m=0).segment(Cloud("map", site())).segments
    assert len(found) == len(SPOTS)
    assert all(not len(one.foot) for one in found)


def test_extents_are_those_of_the_stone() -> None:
    found = segmenter().segment(Cloud("map", site())).segments
    biggest = max(found, key=lambda s: s.extents[0])
    np.testing.assert_allclose(biggest.extents[:2], [2 * 0.69, 1.6 * 0.69], rtol=0.1)
    assert (np.diff(biggest.extents) <= 0).all()


def test_nothing_but_rough_ground_has_no_segments() -> None:
    rng = np.random.default_rng(3)
    xy = rng.uniform(-10, 10, (60_000, 2))
    points = np.column_stack([xy, 2 * heights(xy) + rng.normal(0, 0.015, len(xy))])
    assert segmenter().segment(Cloud("map", points)).segments == ()


def test_a_board_lying_aslant_is_no_stone() -> None:
    rng = np.random.default_rng(3)
    board = (
        np.column_stack([rng.uniform(-0.6, 0.6, (3000, 2)), rng.normal(0, 0.004, 3000)])
        @ from_rpy(0, 0.5, 0).T
    )
    points = np.vstack([site(), board + np.array([-5, -5, 0.6])])
    assert len(segmenter().segment(Cloud("map", points)).segments) == len(SPOTS)


def test_a_flat_stone_is_no_ground() -> None:
    rng = np.random.default_rng(3)
    top = np.column_stack([rng.uniform(-0.7, 0.7, (2500, 2)), np.full(2500, 0.3)])
    side = np.column_stack(
        [rng.uniform(-0.7, 0.7, 1200), np.full(1200, -0.7), rng.uniform(0, 0.3, 1200)]
    )
    flat = np.vstack([top, side, side[:, [1, 0, 2]]]) + np.array(
        [-5, -5, heights(np.array([[-5.0, -5.0]]))[0]]
    )
    found = segmenter().segment(Cloud("map", np.vstack([site(), flat]))).segments
    assert len(found) == len(SPOTS) + 1


def test_the_answer_moves_with_the_frame() -> None:
    cloud = site()
    T = pose(
        from_rpy(0.15, -0.1, 2.0), np.array([400_000.0, 5_200_000.0, 450.0])
    )  # a national grid
    here = segmenter().segment(Cloud("map", cloud))
    there = segmenter().segment(Cloud("utm", transform(T, cloud)))
    assert there.frame == "utm"
    assert len(there.segments) == len(here.segments)
    for segment in here.segments:
        expected = transform(T, segment.centroid)
        nearest = min(np.linalg.norm(other.centroid - expected) for other in there.segments)
        assert (
            nearest < 0.02
        )  # the ground's grid lies otherwise, so the cut differs by a few points
    moved_normal = T[:3, :3] @ here.ground_plane[:3]
    np.testing.assert_allclose(there.ground_plane[:3], moved_normal, atol=5e-3)
    ground = there.ground.points
    assert np.abs(ground @ there.ground_plane[:3] - there.ground_plane[3]).max() < 0.35


@pytest.mark.parametrize(("count", "match"), [(0, "cloud of 0 points"), (1, "cloud of 1 points")])
def test_a_cloud_without_points_is_refused(count: int, match: str) -> None:
    with pytest.raises(DataError, match=match):
        segmenter().segment(Cloud("map", np.zeros((count, 3))))


def test_a_cloud_of_one_point_a_thousand_times_is_refused() -> None:
    with pytest.raises(DataError, match="no ground"):
        segmenter().segment(Cloud("map", np.ones((1000, 3))))


def test_settings_out_of_range_are_refused() -> None:
    with pytest.raises(ValueError, match="plane_margin_m"):
        segmenter(plane_margin_m=-0.1)


def box(size: tuple[float, float, float], place: tuple[float, float]) -> np.ndarray:
    rng = np.random.default_rng(3)
    points = rng.uniform(-0.5, 0.5, (8000, 3))
    axis, side = rng.integers(3, size=8000), rng.choice([-0.5, 0.5], 8000)
    points[np.arange(8000), axis] = np.where(axis == 2, 0.5, side)
    return (points + [0, 0, 0.5]) * size + [*place, 0.0]


@pytest.mark.parametrize(
    ("parts", "kind", "reason"),
    [
        ([box((3.4, 1.2, 0.9), (-3, -5))], "too_large", " m long, more than 3.00 m"),
        ([box((0.4, 0.35, 1.7), (-3, -5))], "structure", "stands upright: 1.6"),
        ([box((4.2, 0.6, 0.5), (-3, -5)), box((0.6, 3.2, 0.5), (-1.2, -6.9))],
          "stack|structure|too_large", "hollow|more than 3.00 m|too large or stacks"),
        ([box((0.2, 0.15, 0.3), (-3, -5))], "too_small", "m long, less than 0.50 m"),
        ([box((2.5, 0.02, 1.5), (-3, -5))], "structure", "of its points are on one plane"),
        ([box((24.0, 0.3, 2.0), (0, -8))], "structure", "m wide, more than any heap (20 m)"),
    ],
)  # fmt: skip
def test_what_is_no_stone_is_told_with_a_reason(
    parts: list[np.ndarray], kind: str, reason: str
) -> None:
    alone = segmenter().segment(Cloud("map", site()))
    assert alone.left_out == ()
    limits = {"min_extent_m": 0.5} if kind == "too_small" else {}
    found = segmenter(**limits).segment(Cloud("map", np.vstack([site(), *parts])))
    assert len(found.segments) == len(SPOTS)
    first = found.left_out[0]
    assert first.kind in kind.split("|")
    assert any(one in first.reason for one in reason.split("|"))
    assert first.points > 0.5 * sum(len(part) for part in parts)
    total = len(found.ground) + found.scattered_points
    total += sum(len(s.points) for s in found.segments) + sum(x.points for x in found.left_out)
    assert total == len(site()) + sum(len(part) for part in parts)  # nothing is lost


def test_two_joined_stones_longer_than_any_are_two() -> None:
    pair = [box((1.7, 1.2, 0.9), (-3, -5)), box((1.7, 1.1, 0.9), (-1.28, -5))]
    found = segmenter().segment(Cloud("map", np.vstack([site(), *pair])))
    assert len(found.segments) == len(SPOTS) + 2
    assert found.left_out == ()


def test_sizes_are_those_of_the_machine() -> None:
    slim = box((2.3, 0.9, 0.7), (-3, -5))
    cloud = Cloud("map", np.vstack([site(), slim]))
    large = GroundAndClusters(GroundAndClustersSettings(), load_machine("m545")).segment(cloud)
    assert len(large.segments) == len(SPOTS) + 1
    small = GroundAndClusters(GroundAndClustersSettings(), load_machine("mini")).segment(cloud)
    assert len(small.segments) == len(SPOTS)
    (rest,) = small.left_out
    assert rest.kind is PartKind.TOO_LARGE
    assert "more than 1.96 m" in rest.reason


def test_what_the_jaws_cannot_span_is_too_large() -> None:
    machine = load_machine("mini").model_copy()
    cube = box((1.8, 1.75, 1.7), (-3, -5))
    settings = GroundAndClustersSettings(max_extent_m=5.0)
    found = GroundAndClusters(settings, machine).segment(Cloud("map", np.vstack([site(), cube])))
    assert "more than the jaws' opening of 1.52 m" in found.left_out[0].reason


def test_a_stone_on_a_rise_is_seen_and_the_rise_is_not() -> None:
    points = site()
    points[:, 2] += 0.3 * np.sin(points[:, 0] * 2 * np.pi / 8)
    found = segmenter().segment(Cloud("map", points))
    assert len(found.segments) == len(SPOTS)
    assert found.left_out == ()


def test_stones_of_a_wide_site_are_found() -> None:
    rng = np.random.default_rng(0)
    xy = rng.uniform(-80, 80, (300_000, 2))
    wide = np.column_stack([xy, heights(xy)])[np.abs(xy).max(axis=1) > 10]
    found = segmenter().segment(Cloud("map", np.vstack([site(), wide])))
    assert len(found.segments) == len(SPOTS)
    assert not any("z down" in one for one in found.warnings)


def test_a_coarse_cloud_shows_what_it_can_and_says_so() -> None:
    points = site()
    coarse = points[np.random.default_rng(5).permutation(len(points))[::25]]
    found = segmenter().segment(Cloud("map", coarse))
    assert len(found.segments) >= 4
    assert any("m apart: stones shorter than" in one for one in found.warnings)


def test_a_site_in_feet_is_suspected() -> None:
    found = segmenter().segment(Cloud("map", site() / 0.3048))
    assert any("is the unit the metre?" in one for one in found.warnings)


def test_a_cloud_with_z_down_or_y_up_is_warned_of() -> None:
    assert segmenter().segment(Cloud("map", site())).warnings == ()
    down = segmenter().segment(Cloud("map", site() * (1, -1, -1)))
    assert any("is z down?" in one for one in down.warnings)
    floor = np.random.default_rng(0).uniform([-5, -5, 0], [5, 5, 0.02], (9000, 3))
    upright = segmenter().segment(Cloud("map", np.vstack([site()[:, [0, 2, 1]], floor])))
    assert any("is z up?" in one for one in upright.warnings)


@pytest.mark.parametrize(("lift_m", "kinds"), [(1.5, [PartKind.STRUCTURE]), (0.0, [])])
def test_what_hangs_in_the_air_is_no_stone(lift_m: float, kinds: list[PartKind]) -> None:
    """The same body on the ground is one."""
    rng = np.random.default_rng(3)
    body = stone(np.array([-3.0, -4.0]), 0.6, rng) + [0.0, 0.0, lift_m]
    found = segmenter().segment(Cloud("map", np.vstack([site(), body])))
    assert [one.kind for one in found.left_out] == kinds
    assert len(found.segments) == len(SPOTS) + 1 - len(kinds)
