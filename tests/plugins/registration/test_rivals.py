"""Sites that two motions explain, and what else is told with an answer."""

from functools import cache

import numpy as np
import pytest
from executive_plugins.registration.evidence import Evidence
from executive_plugins.registration.segment_registrar import SegmentRegistrar
from executive_plugins.registration.similarity import Similarity
from executive_plugins.registration.site_view import SiteView
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import from_rpy, log_so3
from executive.messages.cloud import Cloud
from executive.testing.exercises.registration import T_TRUE, mapped, survey
from executive.testing.subject import subject_of

T_FAR = pose(from_rpy(0.02, -0.03, 2.1), np.array([11.0, -4.0, 1.5]))
ALONG = np.linspace(-4.75, 4.75, 6)  # six places at equal distances


@cache
def registrar() -> SegmentRegistrar:
    plugin = subject_of("registration", "segment_shot", ()).started().__enter__()
    assert isinstance(plugin, SegmentRegistrar)
    return plugin


def block(size: tuple[float, float, float], rng: np.random.Generator) -> Float:
    """Return points on the top and the sides of a block that stands on the origin [m]."""
    points = rng.uniform(-0.5, 0.5, (6000, 3))
    axis, side = rng.integers(3, size=6000), rng.choice([-0.5, 0.5], 6000)
    points[np.arange(6000), axis] = np.where(axis == 2, 0.5, side)
    return (points + [0, 0, 0.5]) * size


def row(sizes: list[tuple[float, float, float]], seen: slice, seed: int, wave_m: float) -> Float:
    """Return a row of blocks and the ground about those that are seen [m]."""
    rng = np.random.default_rng(seed)
    places = ALONG[seen]
    ground = rng.uniform([-3, places[0] - 1, 0], [3, places[-1] + 1, 0], (30_000, 3))
    ground[:, 2] = wave_m * np.sin(1.1 * ground[:, 0] + 0.9 * ground[:, 1])
    blocks = [block(s, rng) + [0, y, -0.02] for s, y in zip(sizes[seen], places, strict=True)]
    points = np.vstack([ground, *blocks])
    return points + rng.normal(0, 0.008, points.shape)


def registered(sizes: list[tuple[float, float, float]], first: slice, second: slice, wave_m=0.0):
    target = Cloud("map", row(sizes, first, 1, wave_m))
    source = transform(inverse(T_FAR), row(sizes, second, 2, wave_m))
    return registrar().register(target, Cloud("survey", source), np.random.default_rng(0))


TWINS = [(1.0, 0.7, 0.6)] * 6
SINGLES = [(1.0, 0.7, 0.6), (0.6, 0.9, 0.8), (1.2, 0.5, 0.5), (0.8, 0.8, 0.4), (0.5, 1.1, 0.7)]


def test_identical_blocks_at_equal_distances_are_refused_and_both_motions_are_told() -> None:
    found = registered(TWINS, slice(0, 4), slice(2, 6))
    assert not found.accepted
    assert found.reason.startswith("two motions explain the site")
    assert found.rival is not None
    assert found.rival.likelihood_ratio > 0.01
    assert len(found.rival.matched_segments) >= 2
    middles = transform(inverse(T_FAR), np.column_stack([np.zeros(6), ALONG, np.full(6, 0.3)]))
    apart = found.apply(middles) - transform(found.rival.T_target_source, middles)
    assert np.linalg.norm(apart, axis=1).max() > 1.0


def test_different_blocks_in_the_same_places_are_accepted_with_their_rival() -> None:
    found = registered([*SINGLES, (0.9, 0.9, 0.9)], slice(0, 5), slice(1, 6))
    assert found.accepted, found.reason
    np.testing.assert_allclose(found.T_target_source, T_FAR, atol=0.03)
    assert found.rival is None or found.rival.likelihood_ratio < 1e-6


def evidence(wave_m: float, sizes: list[tuple[float, float, float]] = TWINS) -> Evidence:
    """Return what can be compared of two clouds of one row in one frame."""
    segmenter = GroundAndClusters(GroundAndClustersSettings())
    seen = [
        segmenter.segment(Cloud("map", row(sizes, slice(0, 6), seed, wave_m))) for seed in (1, 2)
    ]
    return Evidence(SiteView(seen[0], 0.08), SiteView(seen[1], 0.08), 0.10, 0.6)


def test_only_what_a_view_shows_to_be_empty_is_open() -> None:
    rng = np.random.default_rng(3)
    points = row(TWINS, slice(0, 2), 3, 0.0)
    seen = GroundAndClusters(GroundAndClustersSettings()).segment(Cloud("map", points))
    view = SiteView(seen, 0.08)
    above_ground, above_block = [2.0, ALONG[0], 0.3], [0.0, ALONG[0], 0.9]
    inside_block, beyond_view = [0.0, ALONG[0], 0.3], [0.0, ALONG[4], 0.3]
    places = np.array([above_ground, above_block, inside_block, beyond_view])
    places[:, :2] += rng.uniform(-0.05, 0.05, (4, 2))
    assert view.is_open(places, 0.1).tolist() == [True, True, False, False]


STAY, SHIFTED = Similarity(np.eye(4), 1.0), Similarity(pose(t=np.array([0.0, 1.9, 0.0])), 1.0)


@pytest.mark.parametrize(("wave_m", "least", "most"), [(0.0, -0.3, 0.3), (0.12, 1.0, 4.5)])
def test_the_ground_speaks_against_a_shift_if_it_has_relief(
    wave_m: float, least: float, most: float
) -> None:
    excess, count = evidence(wave_m).relief_excess(STAY, SHIFTED)
    assert least <= excess <= most
    assert count > 5  # of some forty square metres


def test_ground_that_was_worked_since_the_survey_says_nothing() -> None:
    assert evidence(0.12).relief_excess(SHIFTED, STAY) == (0.0, 0.0)


def test_a_stone_where_the_other_cloud_shows_plain_ground_speaks_against_a_motion() -> None:
    """Shifted by one place, the last stone of either cloud stands beside the row; by half a place
    all stand on ground that was seen.
    """
    half = Similarity(pose(t=np.array([0.0, 0.95, 0.0])), 1.0)
    compared = evidence(0.0)
    pairs = tuple((i, i) for i in range(6))
    assert compared.contradicted(STAY, pairs) == 0.0
    assert compared.contradicted(half, ()) > 60.0  # patches: more than five of each stone


def test_a_small_change_of_a_motion_never_takes_away_what_surely_contradicts_it() -> None:
    compared, rng = evidence(0.0, [(0.5, 0.4, 0.4)] * 6), np.random.default_rng(4)
    beside, pairs = pose(t=np.array([1.6, 0.95, 0.0])), ((0, 0), (1, 1))
    surely = compared.surely_contradicted(Similarity(beside, 1.0), pairs, 0.1)
    assert surely > 20.0
    for shift in rng.uniform(-0.07, 0.07, (20, 2)):
        changed = Similarity(beside @ pose(t=np.array([*shift, 0.0])), 1.0)
        assert compared.contradicted(changed, pairs) >= surely


def test_stones_that_may_come_to_lie_on_others_contradict_nothing_surely() -> None:
    shifted = Similarity(pose(t=np.array([0.0, 1.9, 0.0])), 1.0)
    pairs = tuple((i, i + 1) for i in range(5))
    assert evidence(0.0).surely_contradicted(shifted, pairs, 0.5) == 0.0


def test_nothing_is_sure_of_a_motion_that_brings_no_stones_near_each_other() -> None:
    aside = Similarity(pose(t=np.array([1.6, 0.95, 0.0])), 1.0)
    assert evidence(0.0).surely_contradicted(aside, (), 0.1) == 0.0


def test_a_survey_of_two_stones_is_refused_for_good() -> None:
    found = registered(SINGLES[:2], slice(0, 2), slice(0, 2))
    assert (found.accepted, found.is_final) == (False, True)
    assert found.reason == "too few stones in view: target 2, source 2, need 3"


def test_a_map_of_two_stones_may_still_grow() -> None:
    found = registered(SINGLES, slice(0, 2), slice(0, 4))
    assert (found.accepted, found.is_final) == (False, False)


def test_the_error_of_a_motion_is_within_what_its_covariance_says() -> None:
    found = registrar().register(mapped(1), survey(1), np.random.default_rng(3))
    assert found.uncertainty is not None
    covariance, centre = found.uncertainty.covariance, found.uncertainty.centre
    assert np.linalg.eigvalsh(covariance).min() > 0
    std = np.sqrt(np.diag(covariance))
    assert std[:3].max() < np.radians(0.3)
    assert std[3:].max() < 0.02
    R, t = T_TRUE[:3, :3], T_TRUE[:3, 3]
    at_centre = R.T @ (1.006 * centre - t)
    error = np.r_[
        log_so3(found.T_target_source[:3, :3] @ R.T),
        found.apply(at_centre[None])[0] - centre,
    ]
    assert error @ np.linalg.solve(covariance, error) < 22.5  # χ² of six unknowns, 99.9 %


@pytest.mark.parametrize("count", [40, 90])
def test_many_stones_take_bounded_memory(count: int) -> None:
    from executive_plugins.registration.constellation import _MOST_MOTIONS, _hypotheses

    rng = np.random.default_rng(count)
    places = rng.uniform(0, 2.2 * np.sqrt(count), (count, 2))
    assert 0 < len(_hypotheses(places, places, 0.5)) <= _MOST_MOTIONS
