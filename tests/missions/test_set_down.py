"""A stone that slips is lowered to the ground; one that has fallen meanwhile is not."""

import pytest

SET_DOWN = "let_go/0:sequence/0:do/0:sequence"
LOWERED = f"{SET_DOWN}/2:reactive_sequence/1:ExecuteTrajectory"
MOCKS = f"""api: 1
mocks:
  NoStoneLeft: failure
  SelectLargest: success
  FindFreeSlots: success
  DetectSlip: failure
  HasArrived: failure
  IsHolding: HOLDING
expect:
  visited: [{SET_DOWN}/1:PlanSetDown, let_go/0:sequence/1:ReleaseStone]
  LOWERING: [{LOWERED}]
"""


@pytest.mark.parametrize(
    ("holding", "lowering"), [("success", "visited"), ("[success, failure]", "not_visited")]
)
def test_the_gripper_is_lowered_only_with_a_stone(command_line, tmp_path, holding, lowering):
    mocks = tmp_path / "slip.yaml"
    text = MOCKS.replace("HOLDING", holding).replace("LOWERING", lowering)
    if lowering == "visited":  # both lists are one
        text = text.replace(f"]\n  visited: [{LOWERED}", f", {LOWERED}")
    mocks.write_text(text)
    answer = command_line("run", "relocate", "--dry", "--failures", "0", "--mocks", str(mocks))
    assert answer.status == 0, answer.err


def rehearsed(command_line, tmp_path, *lines):
    """Run `relocate` dry with mocked leaves, and return the answer."""
    mocks = tmp_path / "mocks.yaml"
    mocks.write_text("\n".join(["api: 1", "mocks:", *lines]) + "\n")
    return command_line("run", "relocate", "--dry", "--failures", "0", "--mocks", str(mocks))


def test_a_stone_that_is_too_heavy_is_tried_once(command_line, tmp_path):
    answer = rehearsed(
        command_line, tmp_path,
        "  NoStoneLeft: [failure, success]", "  SelectLargest: success", "  FindFreeSlots: success",
        "  PlanGrasp: {status: failure, final: true, reason: too heavy}",
        "expect:", "  ends: {PlanGrasp: [failure]}", "  not_visited: [PlanPick, look_again]",
    )  # fmt: skip
    assert answer.status == 0, answer.err


def test_a_stone_that_is_seen_off_its_place_is_picked_again(command_line, tmp_path):
    answer = rehearsed(
        command_line, tmp_path,
        "  NoStoneLeft: [failure, success]", "  SelectLargest: success", "  FindFreeSlots: success",
        "  VerifyPlacement: [failure, success]", "  DetectSlip: success",
        "expect:", "  visited: [look_again, VerifyPlacement]",
    )  # fmt: skip
    assert answer.status == 0, answer.err


def test_a_stone_that_is_not_seen_at_its_place_is_looked_for_on_a_wider_scan(
    command_line, tmp_path
):
    answer = rehearsed(
        command_line, tmp_path,
        "  NoStoneLeft: [failure, success]", "  SelectLargest: success", "  FindFreeSlots: success",
        "  RelocateAndRealign: failure", "  FindAgain: success", "  DetectSlip: success",
        "  VerifyPlacement: success",
        "expect:", "  visited: [see_released, FindAgain]", "  not_visited: [look_again]",
    )  # fmt: skip
    assert answer.status == 0, answer.err


def test_a_stone_that_is_seen_nowhere_is_sought_and_picked_again(command_line, tmp_path):
    answer = rehearsed(
        command_line, tmp_path,
        "  NoStoneLeft: [failure, success]", "  SelectLargest: success", "  FindFreeSlots: success",
        "  RelocateAndRealign: failure", "  FindAgain: failure", "  DetectSlip: success",
        "  VerifyPlacement: [failure, success]", "  ForgetPlace: success",
        "expect:", "  visited: [look_again, FindLost, VerifyPlacement]",
    )  # fmt: skip
    assert answer.status == 0, answer.err


COURSES = """api: 1
mocks:
  StonesThatMatch: {status: success, outputs: {matching: [1, 2], matching_stones: []}}
  FindCourseSlots: {status: success, outputs: {slots: []}}
  NoStoneMatches: success
  CheckPlaced: LOOK
"""


@pytest.mark.parametrize(
    ("look", "status", "words"),
    [
        ("success", 0, "two_courses, dry"),
        ("{status: failure, reason: stone 3 is not seen}", 1, "stone 3 is not seen"),
    ],
)
def test_two_courses_stand_if_the_last_look_shows_them(command_line, tmp_path, look, status, words):
    mocks = tmp_path / "mocks.yaml"
    mocks.write_text(COURSES.replace("LOOK", look))
    answer = command_line("run", "two_courses", "--dry", "--failures", "0", "--mocks", str(mocks))
    assert (answer.status, words in answer.err) == (status, True)
