"""The check of a place by settling: what one place leaves behind changes no other."""

import numpy as np
import pytest
from executive_plugins.placing.dry_stone import stability
from executive_plugins.placing.dry_stone.parts import Place
from executive_plugins.placing.dry_stone.settings import CheckSettings
from executive_plugins.placing.dry_stone.stability import Checks, TrialsOfStructure

from executive.geometry.pose import pose
from executive.messages.building import StandingStone
from executive.testing.exercises.building import box, first_course

SETTINGS = CheckSettings(pieces=1, samples=1, noise=0.005, tilt_noise=0.005)
STONE = box("next", 0.9, 0.6, 0.3)
HOLDS, FALLS = (Place(STONE, pose(t=np.array([x, 0.0, 0.56])), 0.0, {}) for x in (0.0, 1.6))


def found_at(check: Checks, place: Place, built):
    return check.check(place, built, np.random.default_rng(3), lambda: True)


def test_a_place_is_judged_alike_alone_and_after_another() -> None:
    built, check = first_course(), Checks(SETTINGS)
    alone = found_at(Checks(SETTINGS), HOLDS, built)
    fallen = found_at(check, FALLS, built)
    after = found_at(check, HOLDS, built)
    assert (alone.refusal, bool(fallen.refusal)) == ("", True)
    np.testing.assert_array_equal(after.T_map_settled, alone.T_map_settled)
    assert (after.refusal, after.worst_m, after.terms) == ("", alone.worst_m, alone.terms)


def test_a_structure_finds_its_rest_once_and_anew_when_it_has_changed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rested, rest_of = [], stability.rest_of
    monkeypatch.setattr(stability, "rest_of", lambda *of: rested.append(of[0]) or rest_of(*of))
    built, check = first_course(), Checks(SETTINGS)
    for structure in (built, built, built.with_standing(built.standing[0])):
        found_at(check, HOLDS, structure)
    assert [len(one.standing) for one in rested] == [len(built.standing), 1]


def row_of_boxes(count: int):
    """Return boxes of 0.9 m in a row along the wall, 4 cm apart; the first is in the middle."""
    stones = [
        StandingStone(box(f"box_{k}", 0.9, 0.7, 0.4), pose(t=np.array([0.94 * k, 0.0, 0.2])))
        for k in range(count)
    ]
    return first_course().with_standing(*stones)


def test_only_stones_within_reach_move_and_far_ones_are_left_out() -> None:
    # Above the first box and beside the second; the third is what the second may lean on.
    model = TrialsOfStructure(SETTINGS).of(row_of_boxes(5), HOLDS).world.model
    bodies = [model.body(number) for number in range(1, model.nbody)]
    assert [len(body.dofadr) > 0 and body.dofadr[0] >= 0 for body in bodies] == [
        True, True, False, True,  # the row's first two; the third, which holds still; the stone
    ]  # fmt: skip


def test_a_place_is_judged_as_it_is_on_a_wall_that_ends_beyond_its_reach() -> None:
    short, long = (found_at(Checks(SETTINGS), HOLDS, row_of_boxes(n)) for n in (4, 9))
    assert (short.refusal, short.terms) == (long.refusal, long.terms)
    np.testing.assert_allclose(short.T_map_settled, long.T_map_settled, atol=1e-9)


def test_a_stone_that_another_would_push_away_is_free_to_be_pushed() -> None:
    """A neighbour within reach is no fixed support: a place that moves it is refused."""
    slender = StandingStone(box("slender", 0.1, 0.6, 0.8), pose(t=np.array([0.55, 0.0, 0.4])))
    built = first_course().with_standing(slender)
    found = found_at(
        Checks(SETTINGS), Place(STONE, pose(t=np.array([0.3, 0.0, 0.97])), 0, {}), built
    )
    assert found.refusal


@pytest.mark.parametrize(("x", "refusal"), [(0.5, ""), (1.55, "topples")])
def test_a_place_that_does_not_hold_among_fixed_stones_is_not_tried_among_free_ones(
    monkeypatch, x: float, refusal: str
) -> None:
    """Over the end of the course a stone topples off, whether the others hold still or not."""
    place, tried = Place(box("next", 0.6, 0.6, 0.3), pose(t=np.array([x, 0.0, 0.6])), 0.0, {}), []
    of = TrialsOfStructure.of
    monkeypatch.setattr(TrialsOfStructure, "of", lambda *given: tried.append(given) or of(*given))
    settings = CheckSettings(pieces=1, samples=1, noise=0.0, tilt_noise=0.0)
    found = Checks(settings).check(place, first_course(), np.random.default_rng(0), lambda: True)
    assert found.refusal == refusal
    assert bool(tried) == (not refusal)


def test_a_place_that_noise_takes_away_is_not_tried_among_free_stones(monkeypatch) -> None:
    """At the edge of the course a stone rests where it is let go, and falls from farther out."""
    place = Place(box("next", 0.6, 0.6, 0.3), pose(t=np.array([0.5, 0.3, 0.56])), 0.0, {})
    tried, of = [], TrialsOfStructure.of
    monkeypatch.setattr(TrialsOfStructure, "of", lambda *given: tried.append(given) or of(*given))
    refusals = []
    for noise in (0.0, 0.06):
        settings = CheckSettings(pieces=1, other_pieces=0, samples=8, noise=noise, tilt_noise=0)
        check = Checks(settings)
        refusals.append(found_at(check, place, first_course()).refusal)
    assert refusals[0] == ""
    assert refusals[1].endswith("_under_noise")
    assert len(tried) == 1  # without noise


def test_places_of_one_cell_share_their_worlds_and_others_do_not() -> None:
    trials, built = TrialsOfStructure(SETTINGS), row_of_boxes(5)
    here, beside, far = (
        trials.among_fixed(built, Place(STONE, pose(t=np.array([x, 0.0, 0.56])), 0.0, {}))
        for x in (0.0, 0.3, 3.0)
    )
    assert here is beside
    assert far is not here
    assert trials.among_fixed(row_of_boxes(5), HOLDS) is not here  # another structure


def test_a_world_of_a_cell_holds_what_a_stone_can_reach_from_its_edge() -> None:
    place = Place(STONE, pose(t=np.array([0.49, 0.0, 0.56])), 0.0, {})
    trial = TrialsOfStructure(SETTINGS).among_fixed(row_of_boxes(9), place).trial
    # Of the boxes at 0, 0.94, 1.88, 2.82 m and so on: 0.5 + 0.56 + 0.25 m and what noise adds.
    assert trial.world.model.nbody == 1 + 3 + 1


def test_without_a_neighbour_nothing_is_fixed() -> None:
    place = Place(box("next", 0.6, 0.6, 0.3), pose(t=np.array([6.0, 0.0, 0.2])), 0.0, {})
    assert TrialsOfStructure(SETTINGS).among_fixed(first_course(), place).is_alone


@pytest.mark.parametrize(("most_tilt", "refusal"), [(None, ""), (0.2, ""), (0.05, "tilts")])
def test_a_stone_may_tilt_as_it_settles_by_no_more_than_is_allowed(
    most_tilt: float | None, refusal: str
) -> None:
    """One edge on a box of 0.1 m, the other on the ground: 0.1 m over 0.9 m are 0.11 rad."""
    low = StandingStone(box("low", 0.2, 0.6, 0.1), pose(t=np.array([0.4, 0.0, 0.05])))
    place = Place(STONE, pose(t=np.array([0.0, 0.0, 0.25])), 0.0, {})
    settings = CheckSettings(
        pieces=1, other_pieces=0, samples=1, noise=0.0, tilt_noise=0.0, most_tilt=most_tilt
    )
    found = found_at(Checks(settings), place, first_course().with_standing(low))
    assert found.refusal == refusal
