"""The trees of `build_wall`, without a machine: what follows when an attempt fails."""

import sys
from pathlib import Path

import numpy as np
import pytest

from executive.commands.main import main
from executive.tree.load import load_mission
from executive.tree.traversal import uses_of

MOCKS = """api: 1
mocks:
  Localise: success
  SurveySite: success
  PlanBuilding:
    - {outputs: {stone: 3, free_slots: []}}
    - %s
    - {status: failure, outputs: {ending: complete}}
  PlanGrasp: {outputs: {grasps: [{score: 0.5}]}}
  KeepFittingGrasps: {outputs: {fitting: [{score: 0.5}]}}
  %s: [failure, success]
  ForgetPlace: success
  DetectSlip: success
  SeeUnderside: {outputs: {underside_is_new: false}}
  VerifyPlacement: success
  SetAside: success
  SomeStonePlaced: success
expect:
  outcome: success
  ends: {%s}
"""
AGAIN = "{outputs: {stone: 3, free_slots: []}}"
NO_PLACE = "{status: failure, reason: nothing_fits, final: true}"


@pytest.mark.parametrize(
    ("second_plan", "ends"),
    [
        # It is looked for, planned anew, and grasped anew.
        (AGAIN, "FindAgain: [success], PlanBuilding: [success, success, failure], "
                "PlanGrasp: [success, success], PlanPick: [success, success]"),
        # Without a place for it, it is not taken to the one that was planned before.
        (NO_PLACE, "PlanGrasp: [success], SetAside: [success], FindAgain: [success]"),
    ],
    ids=["another place", "no other place"],
)  # fmt: skip
def test_jaws_that_close_on_nothing_are_followed_by_a_look_and_a_new_plan(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, second_plan: str, ends: str
) -> None:
    assert exit_status(monkeypatch, tmp_path, MOCKS % (second_plan, "CloseGripper", ends)) == 0


UNLIKELY = """api: 1
mocks:
  Localise: success
  SurveySite: success
  PlanBuilding:
    - {outputs: {stone: 3, free_slots: []}}
    - {status: failure, outputs: {ending: no_stones}}
  PlanGrasp: %s
  DetectSlip: success
  SeeUnderside: {outputs: {underside_is_new: false}}
  VerifyPlacement: success
  SetAside: success
  TakeUpAgain: failure
  SomeStonePlaced: success
expect:
  outcome: success
  ends: {%s}
"""


@pytest.mark.parametrize(
    ("grasps", "ends"),
    [
        ("{outputs: {grasps: [{score: 0.49}]}}",
         "SetAside: [success], KeepFittingGrasps: [], FindAgain: []"),
        ("{outputs: {grasps: [{score: 0.51}]}}", "SetAside: [], KeepFittingGrasps: [success]"),
        # Without any grasp it lies as it did: neither place nor grasp is planned again.
        ("failure", "PlanGrasp: [failure], PlanBuilding: [success, failure], "
                    "SetAside: [success], FindAgain: []"),
    ],
)  # fmt: skip
def test_a_stone_that_no_grasp_is_likely_to_hold_is_left_without_an_attempt(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, grasps: str, ends: str
) -> None:
    assert exit_status(monkeypatch, tmp_path, UNLIKELY % (grasps, ends)) == 0


TWICE = """api: 1
mocks:
  Localise: success
  SurveySite: success
  PlanBuilding:
    - {outputs: {stone: 3, free_slots: [{id: 1}, {id: 2}]}}
    - %s
    - {status: failure, outputs: {ending: complete}}
  PlanGrasp: {outputs: {grasps: [{score: 0.9}]}}
  KeepFittingGrasps: %s
  DetectSlip: success
  SeeUnderside: {outputs: {underside_is_new: false}}
  VerifyPlacement: %s
  %s
  SomeStonePlaced: success
expect:
  outcome: success
  ends: {%s}
"""
FITTING = "{outputs: {fitting: [{score: 0.9}]}}"


@pytest.mark.parametrize("first", ["{status: failure}", "{outputs: {fitting: [{score: 0.4}]}}"])
def test_places_are_planned_for_the_jaws_where_no_likely_grasp_fits(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, first: str
) -> None:
    """Nobody has touched the stone: it is not looked for."""
    ends = (
        "PlanBuilding: [success, success, failure], PlanGrasp: [success], PlanPick: [success], "
        "FindAgain: [], SetAside: []"
    )
    mocks = TWICE % (AGAIN, f"[{first}, {FITTING}]", "success", "IsHolding: success", ends)
    assert exit_status(monkeypatch, tmp_path, mocks) == 0


@pytest.mark.parametrize(
    ("second_plan", "ends"),
    [
        # It stays in the jaws, and is set down at another place in the same attempt.
        (AGAIN, "PlanPlacement: [failure, success], PlanPick: [success], FindAgain: []"),
        # It has no other place: it is let go where it is.
        (NO_PLACE, "PlanPlacement: [failure], PlanPick: [success], FindAgain: [success]"),
    ],
    ids=["another place", "no other place"],
)
def test_other_places_are_planned_for_a_stone_in_the_jaws_that_reaches_none(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, second_plan: str, ends: str
) -> None:
    assert exit_status(monkeypatch, tmp_path, MOCKS % (second_plan, "PlanPlacement", ends)) == 0


@pytest.mark.parametrize(
    ("second_plan", "ends"),
    [
        # Its place is planned once more, on what was seen of its underside.
        (AGAIN, "PlanPlacement: [success], FindOwnPlace: [], PlanPick: [success]"),
        # It cannot stand anywhere: it is carried back, whatever was planned on its guessed foot.
        (NO_PLACE, "PlanPlacement: [success], FindOwnPlace: [success], ReleaseStone: [success]"),
    ],
    ids=["a place", "no place"],
)
def test_a_stone_that_was_seen_from_below_is_planned_for_once_more(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, second_plan: str, ends: str
) -> None:
    seen = TWICE.replace("underside_is_new: false", "underside_is_new: true")
    held = "IsHolding: success\n  FindOwnPlace: success\n  SetAside: success"
    mocks = seen % (second_plan, FITTING, "success", held, ends)
    assert exit_status(monkeypatch, tmp_path, mocks) == 0


@pytest.mark.parametrize(
    ("verified", "placed", "ends"),
    [
        # A stone far off its place is looked for, and picked again.
        ("[failure, success]", "success", "ReleaseStone: [success, success], FindAgain: [success]"),
        # A neighbour that is not seen any more is for the next plan to adopt.
        ("success", "failure", "ReleaseStone: [success, success], FindAgain: []"),
    ],
)
def test_a_release_is_judged_by_where_the_stone_stands(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, verified: str, placed: str, ends: str
) -> None:
    more = f"CheckPlaced: {placed}\n  ForgetPlace: success"
    mocks = TWICE % (AGAIN, FITTING, verified, more, ends)
    assert exit_status(monkeypatch, tmp_path, mocks) == 0


@pytest.mark.parametrize(
    ("mission", "tilts"), [("build_wall", [3.14159]), ("pick_and_place", [0.35])]
)
def test_a_wall_takes_a_stone_however_it_has_turned(mission: str, tilts: list[float]) -> None:
    nodes = [node for tree in load_mission(mission, ()).trees.values() for node in tree.root.walk()]
    uses = [use for node in nodes for use in uses_of(node) if use.name == "VerifyPlacement"]
    assert [use.settings.tilt for use in uses] == pytest.approx(tilts, abs=1e-4)


LOWERED = """PlanPlacement:
    - {outputs: {placement: {slot: {id: 1}}}}
    - {outputs: {placement: {slot: {id: 2}}}}
  LowerUntilDown: %s
  ForgetPlace: success
  FindOwnPlace: success
  IsHolding: success"""


@pytest.mark.parametrize(
    ("lowered", "second_plan", "ends"),
    [
        # It has met something above its place: it is carried to the next one, in the same attempt.
        ("[failure, success]", "{status: failure, outputs: {ending: complete}}",
         "PlanPlacement: [success, success], ReleaseStone: [success], PlanPick: [success]"),
        # Nor is that one right: it is put back where it lay, lowered until it stands, looked for,
        # and picked again.
        ("[failure, failure, success, success, success]", AGAIN,
         "FindOwnPlace: [success], "
         "LowerUntilDown: [failure, failure, success, success, success], "
         "FindAgain: [success], PlanPick: [success, success]"),
    ],
    ids=["another place", "no place"],
)  # fmt: skip
def test_a_stone_that_meets_something_above_its_place_is_carried_to_another(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, lowered: str, second_plan: str, ends: str
) -> None:
    mocks = TWICE % (second_plan, FITTING, "success", LOWERED % lowered, ends)
    assert exit_status(monkeypatch, tmp_path, mocks) == 0


ONE_PLACE = """api: 1
mocks:
  Localise: success
  SurveySite: success
  PlanBuilding: %s
  PlanGrasp: {outputs: {grasps: [{score: 0.9}]}}
  KeepFittingGrasps: {outputs: {fitting: [{score: 0.9}]}}
  DetectSlip: success
  SeeUnderside: {outputs: {underside_is_new: false}}
  PlanPlacement:
    - {outputs: {placement: {slot: {id: 1}}}}
    - failure
    - failure
    - {outputs: {placement: {slot: {id: 4}}}}
  LowerUntilDown: [failure, success]
  IsHolding: success
  FindOwnPlace: success
  FindAgain: failure
  TakeUpAgain: failure
  SomeStonePlaced: success
expect:
  outcome: success
  ends: {%s}
"""


def test_a_place_that_was_planned_again_is_not_tried_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """The models are the same, and so may be the plan: the stone is put back instead."""
    plans = """
    - {outputs: {stone: 3, free_slots: [{id: 1}]}}
    - {outputs: {stone: 3, free_slots: [{id: 1}]}}
    - {status: failure, outputs: {ending: complete}}"""
    ends = "FindOwnPlace: [success], PlanPlacement: [success, failure, failure, success]"
    mocks = ONE_PLACE % (plans, ends)
    assert exit_status(monkeypatch, tmp_path, mocks) == 0


def test_a_stone_rests_as_far_above_its_plan_as_below_or_is_carried_on() -> None:
    nodes = [n for tree in load_mission("build_wall", ()).trees.values() for n in tree.root.walk()]
    uses = [use for node in nodes for use in uses_of(node) if use.name == "LowerUntilDown"]
    drop_m = 0.05  # of `slots`: the plan is the release, and not the rest
    at_place = [use.settings for use in uses if use.settings.early is not None]
    assert len(at_place) == 2
    for one in at_place:
        assert one.early + drop_m == pytest.approx(one.below - drop_m)


def test_a_stone_that_turns_in_the_jaws_is_taken_by_another_grasp() -> None:
    nodes = [n for tree in load_mission("build_wall", ()).trees.values() for n in tree.root.walk()]
    uses = [use for node in nodes for use in uses_of(node) if use.name == "SeeHeld"]
    assert np.radians(10) in [pytest.approx(use.settings.max_turn) for use in uses]


OVER = """api: 1
mocks:
  Localise: success
  SurveySite: success
  PlanBuilding: {status: failure, outputs: {ending: %s}}
  NoStoneMatches: failure
  SomeStonePlaced: success
expect:
  outcome: success
  ends: {FindLost: [%s], PlanBuilding: [%s]}
"""


@pytest.mark.parametrize(
    ("ending", "looks", "plans"),
    [("all_too_heavy", "success", "failure, failure"), ("complete", "", "failure")],
)
def test_before_it_ends_lost_stones_are_looked_for(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, ending: str, looks: str, plans: str
) -> None:
    assert exit_status(monkeypatch, tmp_path, OVER % (ending, looks, plans)) == 0


def exit_status(monkeypatch: pytest.MonkeyPatch, folder: Path, mocks: str) -> int:
    """Return how a dry run of `build_wall` with these mocks ends."""
    path = folder / "mocks.yaml"
    path.write_text(mocks)
    words = ["run", "build_wall", "--dry", "--failures", "0", "--mocks", str(path)]
    monkeypatch.setattr(sys, "argv", ["executive", *words])
    try:
        main()
    except SystemExit as end:
        return int(end.code or 0)
    return 0
