"""Places at which a stone was let go and did not stay, on a course of three boxes."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.failed_places import FailedPlaces
from executive_plugins.placing.dry_stone.parts import Places
from executive_plugins.placing.dry_stone.planner import DryStone
from executive_plugins.placing.dry_stone.settings import DryStoneSettings

from executive.geometry.pose import pose
from executive.interfaces.building import StructurePlanner
from executive.messages.building import AsBuilt, BuildTarget, FailedRelease, StandingStone
from executive.testing.exercises.building import bare, box, first_course

TOP = box("top", 0.6, 0.6, 0.3)


def planner(**check: object) -> DryStone:
    generator = {"sides": 1, "turns": 1, "cell": 0.1, "finer": 1, "attitude": "kept"}
    check = {"part": "none", **check}
    return DryStone(DryStoneSettings.model_validate({"generator": generator, "check": check}))


def best(plans: StructurePlanner, built: AsBuilt) -> BuildTarget:
    return plans.propose(built, (TOP,), np.random.default_rng(0)).targets[0]


def course(*failed: FailedRelease) -> AsBuilt:
    return replace(first_course(), failed=failed)


def away_m(target: BuildTarget, failed: FailedRelease) -> float:
    return float(np.linalg.norm(target.T_map_settled[:2, 3] - failed.at_map))


def failed_at(target: BuildTarget, supports: frozenset[str], radius_m: float = 0.4):
    return FailedRelease(target.T_map_settled[:2, 3], radius_m, supports)


def all_feet() -> frozenset[str]:
    return frozenset(one.stone.name for one in first_course().standing)


def test_a_place_at_which_a_release_failed_comes_after_others() -> None:
    first = best(planner(), course())
    failed = failed_at(first, all_feet())
    assert away_m(best(planner(), course(failed)), failed) >= 0.4
    assert away_m(best(planner(doubt=0.0), course(failed)), failed) < 1e-9


@pytest.mark.parametrize(("releases", "has_place"), [(1, True), (2, False), (3, False)])
def test_it_is_left_out_once_two_have_failed(releases: int, has_place: bool) -> None:
    """The radius holds the whole structure: no other place is on it."""
    failed = failed_at(best(planner(), course()), all_feet(), 5.0)
    plan = planner().propose(course(*[failed] * releases), (TOP,), np.random.default_rng(0))
    assert bool(plan.targets) == has_place
    if has_place:
        assert plan.targets[0].terms["failed"] == -1.0
    else:
        assert plan.reason == "nothing_fits"
        assert list(plan.by_stone["top"]) == ["fell_there", "no_place"]


def test_a_stone_on_what_was_put_there_since_is_not_at_that_place() -> None:
    """The same point, on another stone than those that bore the one that fell."""
    two = [failed_at(best(planner(), course()), all_feet(), 5.0)] * 2
    cap = StandingStone(box("cap", 0.9, 0.7, 0.1), pose(t=np.array([0.0, 0.0, 0.45])))
    built = course(*two)
    built = built.with_standing(*built.standing, cap)
    target = best(planner(), built)
    assert abs(target.T_map_settled[0, 3]) < 0.75  # it touches the cap
    assert target.T_map_settled[2, 3] == pytest.approx(0.5 + 0.15, abs=1e-6)


@pytest.mark.parametrize(
    ("supports", "radius_m", "count"),
    [
        ({"foot_0"}, 5.0, [1, 0, 0]),
        ({"foot_0", "foot_1"}, 5.0, [1, 1, 1]),
        ({"foot_0", "foot_1"}, 0.6, [1, 1, 0]),
        ({"gone"}, 5.0, [0, 0, 0]),
        (set(), 5.0, [0, 0, 0]),
    ],
)
def test_what_is_touched_tells_whether_it_is_the_same_place(
    supports: set[str], radius_m: float, count: list[int]
) -> None:
    """On the first stone of the course, on the joint of the first two, and on the second."""
    failed = FailedRelease(np.array([-0.98, 0.0]), radius_m, frozenset(supports))
    at = np.array([[x, 0.0, 0.55] for x in (-0.98, -0.49, 0.0)])
    told = FailedPlaces(course(failed), DryStoneSettings()).counted(Places(TOP, np.eye(3), at, {}))
    assert told.tolist() == count


def test_the_ground_bears_whatever_failed_there() -> None:
    failed = FailedRelease(np.zeros(2), 5.0, frozenset({"foot_0"}))
    built = replace(bare(), failed=(failed,) * 2)
    assert planner().propose(built, (TOP,), np.random.default_rng(0)).targets
