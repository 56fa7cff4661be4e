"""Which candidate a registration refines further, on a target whose misfits the test makes."""

from types import SimpleNamespace

import numpy as np
import pytest
from executive_plugins.registration import segment_registrar
from executive_plugins.registration.segment_fpfh import SegmentFpfh
from executive_plugins.registration.settings import SegmentFpfhSettings
from executive_plugins.registration.similarity import Similarity

from executive.geometry.pose import pose

SETTINGS = SegmentFpfhSettings(min_matched=3)
UNIT_M = SETTINGS.truncation_m


class Clouds:
    """A stone at the origin: a motion's shift along x is its misfit, that along y its matches.

    Attributes:
        tried: Misfits that were asked for, as multiples of the truncation.
    """

    def __init__(self) -> None:
        self.stone_points = np.zeros((1, 3))
        self.tried: list[float] = []
        self.stones = SimpleNamespace(nearest=self._nearest)

    def matched(self, motion: Similarity) -> range:
        return range(round(motion.T_target_source[1, 3]))

    def _nearest(self, points: np.ndarray, reach_m: float) -> tuple[np.ndarray, np.ndarray]:
        distances = points[:, 0]
        self.tried.append(round(float(distances[0] / UNIT_M), 9))
        return np.where(distances < reach_m, distances, np.inf), np.zeros(len(points), int)


@pytest.fixture(autouse=True)
def as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """Refinement leaves a candidate where it is."""
    monkeypatch.setattr(segment_registrar, "refine", lambda surface, points, start, *_: start)


def chosen(*candidates: tuple[float, int]) -> tuple[float | None, list[float]]:
    """Return the misfit of the chosen candidate of (misfit, matches), and which were tried."""
    clouds = Clouds()
    poses = [pose(t=np.array([misfit * UNIT_M, votes, 0.0])) for misfit, votes in candidates]
    best = SegmentFpfh(SETTINGS, None, None)._choose(clouds, poses)  # type: ignore[arg-type]
    return (None if best is None else best.T_target_source[0, 3] / UNIT_M), clouds.tried


def test_the_best_fit_is_chosen_and_most_matches_are_tried_first() -> None:
    best, tried = chosen((1.9, 4), (1.4, 6), (1.6, 5))
    assert best == pytest.approx(1.4)
    assert tried == [1.4, 1.6, 1.9]


@pytest.mark.parametrize(("misfit", "is_clear"), [(1.1, True), (1.3, False)])
def test_a_clear_fit_ends_the_search_and_another_does_not(misfit: float, is_clear: bool) -> None:
    best, tried = chosen((0.5, 4), (misfit, 6))
    assert best == pytest.approx(misfit if is_clear else 0.5)
    assert len(tried) == (1 if is_clear else 2)


def test_motions_that_too_few_stones_support_are_not_tried() -> None:
    assert chosen((0.5, 2), (0.9, 2)) == (None, [])
    assert chosen((0.5, 2), (1.5, 3))[0] == pytest.approx(1.5)
    assert chosen() == (None, [])


def test_far_misfits_count_as_twice_the_truncation() -> None:
    """The first of them stays, since none is better."""
    assert chosen((5.0, 6), (2.5, 5))[0] == pytest.approx(5.0)
    assert chosen((5.0, 6), (1.99, 5))[0] == pytest.approx(1.99)
