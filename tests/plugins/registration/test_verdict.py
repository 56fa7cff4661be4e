"""How rivals are weighed, and what becomes of an accepted motion, with evidence made here."""

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from executive_plugins.registration import rivals, verdict
from executive_plugins.registration.evidence import CAP, StoneFit
from executive_plugins.registration.gate import Agreement, Nearness
from executive_plugins.registration.rivals import RivalSearch
from executive_plugins.registration.settings import SegmentFpfhSettings
from executive_plugins.registration.similarity import Similarity
from executive_plugins.registration.verdict import against_rivals

from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.messages.alignment import Alignment, Rival

SETTINGS = SegmentFpfhSettings()
BEST = Similarity(np.eye(4), 1.0)
PAIRS = ((0, 0), (1, 1))


def shifted(x_m: float) -> Similarity:
    return Similarity(pose(t=np.array([x_m, 0.0, 0.0])), 1.0)


def fit(*costs: float, agreeing: int = 2) -> StoneFit:
    """Return a fit with two observations of each pair."""
    return StoneFit(PAIRS, PAIRS[:agreeing], np.array(costs), np.full(len(costs), 2.0))


class Evidence:
    """Says what it is told, and keeps what it was asked.

    A motion's shift along x says which of the given fits is its own.
    """

    def __init__(self, fits: Sequence[StoneFit] = (), **told: Any) -> None:
        self.fits, self.told, self.asked = fits, told, list[str]()

    def contradicted(self, motion: Similarity, pairs: Any) -> float:
        self.asked.append("contradicted")
        return float(self.told.get("contradicted", 0.0))

    def surely_contradicted(self, motion: Similarity, pairs: Any, reach_m: float) -> float:
        assert pairs == PAIRS
        self.asked.append(f"surely within {reach_m:.2f} m")
        return float(self.told.get("surely", 0.0))

    def weight(self, pairs: Any) -> float:
        return float(self.told.get("weight", 0.0))

    def relief_excess(self, best: Similarity, other: Similarity) -> tuple[float, float]:
        self.asked.append("relief")
        found: tuple[float, float] = self.told.get("relief", (0.0, 0.0))
        return found

    def best_fit(self, best: Similarity, matched: Any, agreeing: Any) -> tuple[StoneFit, float]:
        return fit(0.5, 0.5), 0.01

    def stone_fit(self, motion: Similarity, near: Any, noise_m: float) -> StoneFit:
        assert noise_m == 0.01
        return self.fits[round(motion.T_target_source[0, 3]) - 1]


class Clouds:
    """Two stones in either cloud, which every motion brings near each other."""

    settings = SETTINGS

    def __init__(self, evidence: Evidence) -> None:
        self.evidence = evidence

    def matched(self, motion: Similarity) -> tuple[tuple[int, int], ...]:
        return PAIRS

    def is_same(self, one: Similarity, other: Similarity) -> bool:
        return bool(np.allclose(one.T_target_source, other.T_target_source))


def search(evidence: Evidence, hypotheses: int = 10) -> RivalSearch:
    made = RivalSearch(Clouds(evidence), hypotheses)  # type: ignore[arg-type]
    made._on_ground = lambda motion, near: motion  # type: ignore[method-assign]
    made._rough = lambda best, candidates, usual: [  # type: ignore[method-assign]
        Similarity(T, 1.0) for T in candidates
    ]
    made._refined = lambda motion, near: motion  # type: ignore[method-assign]
    return made


@pytest.mark.parametrize(("hypotheses", "shared"), [(0, 1), (1, 1), (20, 20)])
def test_the_allowed_probability_is_shared_by_all_motions_that_were_tried(
    hypotheses: int, shared: int
) -> None:
    limit = search(Evidence(), hypotheses).limit
    assert limit == pytest.approx(SETTINGS.max_wrong_probability / shared)


def test_stones_that_fit_much_worse_decide_alone() -> None:
    evidence = Evidence(contradicted=1.0)
    excess = 2 * (4.0 - 0.5) + 2 * (4.4 - 0.5)
    ratio = search(evidence)._ratio(shifted(1), fit(4.0, 4.4), BEST, fit(0.5, 0.5))
    assert ratio == pytest.approx(np.exp(-excess), rel=1e-9, abs=0.0)
    assert evidence.asked == []


def test_plain_ground_under_stones_counts_next_and_then_the_relief_up_to_a_million() -> None:
    """Against the best motion, too, one observation speaks."""
    own = fit(0.5, 0.5)
    bare = Evidence(contradicted=9.0)
    ground = search(bare)
    ground._for_best = 1.0
    assert ground._ratio(shifted(1), own, BEST, own) == pytest.approx(
        np.exp(-8 * (CAP - 0.5)), rel=1e-9, abs=0.0
    )
    assert bare.asked == ["contradicted"]
    for relief, nats in (((0.5, 6.0), 3.0), ((2.0, 30.0), 13.8)):
        level = Evidence(relief=relief)
        assert search(level)._ratio(shifted(1), own, BEST, own) == pytest.approx(
            np.exp(-nats), rel=1e-9, abs=0.0
        )
        assert level.asked == ["contradicted", "relief"]


def test_a_ratio_is_told_up_to_a_hundred_nats() -> None:
    many = StoneFit(PAIRS, PAIRS, np.zeros(2), np.full(2, 900.0))
    ratio = search(Evidence())._ratio(shifted(1), many, BEST, fit(0.5, 0.5))
    assert ratio == pytest.approx(np.exp(100.0))


def test_the_likeliest_motion_that_lays_two_stones_elsewhere_is_the_rival() -> None:
    fits = fit(0.9, 0.9), fit(0.7, 0.7), fit(0.8, 0.8), fit(0.1, 0.1, agreeing=1)
    asked = search(Evidence(fits, surely=-100.0))
    candidates = [shifted(float(k)).T_target_source for k in (1, 2, 3, 4)]
    rival = asked.best_rival(BEST, PAIRS, candidates)
    assert rival is not None
    assert rival.T_target_source[0, 3] == 2.0
    assert rival.likelihood_ratio == pytest.approx(np.exp(-4 * 0.2), rel=1e-9, abs=0.0)
    assert rival.matched_segments == PAIRS
    assert asked.excluded == 0
    reach_m = 3 * SETTINGS.truncation_m
    assert f"surely within {reach_m:.2f} m" in asked._clouds.evidence.asked  # type: ignore[attr-defined]


def test_only_what_fits_roughly_is_refined_to_the_end() -> None:
    asked, refined = search(Evidence((fit(2.9, 2.9), fit(3.1, 3.1)), surely=-100.0)), list[float]()

    def refine(motion: Similarity, near: Any) -> Similarity:
        refined.append(motion.T_target_source[0, 3])
        return motion

    asked._refined = refine  # type: ignore[method-assign]
    asked.best_rival(BEST, PAIRS, [shifted(1.0).T_target_source, shifted(2.0).T_target_source])
    assert refined == [1.0]


@pytest.mark.parametrize(("surely", "is_excluded"), [(4.0, True), (0.5, False)])
def test_a_motion_that_plain_ground_keeps_below_the_limit_is_excluded(
    surely: float, is_excluded: bool
) -> None:
    """The stones near each other could bring four observations at the usual cost, two nats."""
    evidence = Evidence([fit(0.5, 0.5)], surely=surely, weight=4.0)
    asked = search(evidence, 10)
    assert asked.limit == pytest.approx(SETTINGS.max_wrong_probability / 10)
    ratio = np.exp(0.5 * 4.0 - surely * (CAP - 0.5))
    assert (ratio <= asked.limit) == is_excluded
    assert (asked.best_rival(BEST, PAIRS, [shifted(1.0).T_target_source]) is None) is is_excluded
    assert asked.excluded == is_excluded


def accepted() -> Alignment:
    return Alignment(np.eye(4), True, "2 stones agree", 0.02, 0.8, PAIRS)


class Search:
    """Finds what the test wants."""

    limit, excluded = 1e-3, 0
    rival: Rival | None = None

    def __init__(self, clouds: Any, hypotheses: int) -> None:
        assert hypotheses == 7

    def best_rival(self, best: Similarity, agreeing: Any, candidates: Any) -> Rival | None:
        assert agreeing == PAIRS
        return self.rival


def judged(monkeypatch: pytest.MonkeyPatch, **found: Any) -> Alignment:
    monkeypatch.setattr(verdict, "RivalSearch", type("Found", (Search,), found))
    segments = [SimpleNamespace(centroid=np.array([x, 0.0, 0.0])) for x in (1.0, 3.0)]
    clouds: Any = SimpleNamespace(source=SimpleNamespace(segments=segments))
    return against_rivals(clouds, accepted(), [np.eye(4)] * 7)


def test_without_a_rival_a_motion_stays_accepted(monkeypatch: pytest.MonkeyPatch) -> None:
    found = judged(monkeypatch)
    assert (found.accepted, found.rival) == (True, None)
    assert found.reason == "2 stones agree; no other motion fits two stones"
    excluded = judged(monkeypatch, excluded=3)
    told = " (plain ground under other stones excludes 3)"
    assert excluded.reason == found.reason + told


@pytest.mark.parametrize(("ratio", "is_accepted"), [(1e-3, True), (1.1e-3, False)])
def test_a_rival_is_told_and_refuses_if_it_is_likely_enough(
    monkeypatch: pytest.MonkeyPatch, ratio: float, is_accepted: bool
) -> None:
    rival = Rival(pose(from_rpy(0, 0, np.pi / 2), np.array([0.0, -2.0, 0.0])), 1.0, ratio, PAIRS)
    found = judged(monkeypatch, rival=rival)
    assert found.accepted is is_accepted
    assert found.rival is rival
    # The middle of the stones, (2, 0), comes to (0, 0).
    told = f"another motion, 2.00 m and 90 deg away, on which 2 stones agree, is {ratio:.1e} times"
    begin = "" if is_accepted else "two motions explain the site: "
    assert found.reason == f"{begin}2 stones agree; {told} as likely"


def nearness(rmse_m: float, share: float) -> Nearness:
    """Return one of a thousand points."""
    near = round(1000 * share)
    return Nearness(1000, near, near * rmse_m**2)


@pytest.mark.parametrize(
    ("stones", "rmse_m", "share", "told"),
    [
        (3, 0.039, 0.5, []),
        (2, 0.039, 0.5, ["2 stones agree, need 3"]),
        (3, 0.041, 0.5, ["rmse 4.1 cm above 4.0 cm"]),
        (3, 0.039, 0.49, ["overlap 0.49 below 0.5"]),
        (0, 0.05, 0.1, ["0 stones", "rmse 5.0 cm", "overlap 0.10"]),
    ],
)
def test_each_limit_of_the_gate_is_told_by_itself(
    stones: int, rmse_m: float, share: float, told: list[str]
) -> None:
    settings = SegmentFpfhSettings(min_matched=3, max_rmse_m=0.04, min_overlap=0.5)
    agreement = Agreement(nearness(0.9, 0.05), nearness(rmse_m, share))
    faults = verdict._faults(settings, agreement, stones)
    assert len(faults) == len(told)
    assert all(fault.startswith(begin) for fault, begin in zip(faults, told, strict=True))


class Flat:
    """A surface z = 0 m."""

    def nearest(self, points: np.ndarray, reach_m: float) -> tuple[np.ndarray, np.ndarray]:
        distances = np.abs(points[:, 2])
        return np.where(distances < reach_m, distances, np.inf), np.zeros(len(points), int)


def test_candidates_are_refined_once_each_and_all_that_are_rivals_are_weighed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The best motion, a candidate twice, one without two stones and one over plain ground are no
    rivals; a candidate's height is its misfit.
    """
    reaches: list[tuple[float, ...]] = []

    def refine(surface: Any, points: Any, start: Similarity, wide: Any, scale: float) -> Similarity:
        reaches.append(wide)
        assert (len(points), scale) == (2, 0.0)
        return start

    monkeypatch.setattr(rivals, "refine", refine)
    evidence = Evidence(surely=-100.0)
    clouds = Clouds(evidence)
    clouds.stones = Flat()  # type: ignore[attr-defined]
    segment = SimpleNamespace(points=np.zeros((1, 3)))
    clouds.source = SimpleNamespace(segments=[segment] * 2)  # type: ignore[attr-defined]
    matched = clouds.matched

    def pairs(motion: Similarity) -> tuple[tuple[int, int], ...]:
        return matched(motion)[: 1 if motion.T_target_source[0, 3] == 9.0 else 2]

    clouds.matched = pairs  # type: ignore[method-assign]
    surely = evidence.surely_contradicted

    def over_ground(motion: Similarity, near: Any, reach_m: float) -> float:
        assert reach_m == SETTINGS.coarse_reach_m
        return 50.0 if motion.T_target_source[0, 3] == 8.0 else surely(motion, near, reach_m)

    evidence.surely_contradicted = over_ground  # type: ignore[method-assign]
    made = RivalSearch(clouds, 10)  # type: ignore[arg-type]
    places = [(9, 0.0), (8, 0.0), (1, 0.05), (2, 0.01), (2, 0.01), (0, 0.0), (3, 0.4), (4, 0.02),
              (5, 0.12)]  # fmt: skip
    candidates = [pose(t=np.array([float(x), 0.0, z])) for x, z in places]
    found = made._rough(BEST, candidates, 0.5)
    assert [one.T_target_source[0, 3] for one in found] == [2.0, 4.0, 1.0, 5.0, 3.0]
    assert made.excluded == 1
    reach_m = SETTINGS.coarse_reach_m
    assert reaches == [(reach_m, reach_m, pytest.approx(0.6 * reach_m))] * 5


def test_the_rival_is_told_by_how_far_it_lays_the_middle_and_turns_it() -> None:
    turn = pose(from_rpy(0.0, 0.0, np.pi / 2), np.array([1.0, 0.0, 0.0]))
    best = Similarity(pose(t=np.array([2.0, 0.0, 0.0])), 1.0)
    told = verdict._told(Rival(turn, 1.0, 1e-3, PAIRS), best, np.array([3.0, 4.0, 0.0]))
    # (3, 4) lies at (−3, 3) by the rival, and at (5, 4) by the best motion.
    assert "8.06 m and 90 deg away, on which 2 stones agree, is 1.0e-03 times" in told
