"""A stone that slips is lowered to the ground; one that has fallen meanwhile is not."""

import pytest

SET_DOWN = "let_go/0:sequence/0:do/0:sequence"
SEEN = "see_released/0:sequence/1:fallback"
LOWERED = f"{SET_DOWN}/2:reactive_sequence/2:ExecuteTrajectory"
MOCKS = f"""api: 1
mocks:
  NoStoneLeft: failure
  SelectLargest: success
  FindFreeSlots: success
  DetectSlip: failure
  HasArrived: failure
  IsHolding: HOLDING
  IsHanging: HANGING
expect:
  visited: [{SET_DOWN}/1:PlanSetDown, let_go/0:sequence/2:ReleaseStone]
  LOWERING: [{LOWERED}]
"""


@pytest.mark.parametrize(
    ("holding", "hanging", "lowering"),
    [
        ("success", "success", "visited"),
        ("[success, failure]", "success", "not_visited"),
        ("success", "failure", "not_visited"),
    ],
)
def test_the_gripper_is_lowered_only_with_a_stone_that_hangs(
    command_line, tmp_path, holding, hanging, lowering
):
    mocks = tmp_path / "slip.yaml"
    text = MOCKS.replace("HOLDING", holding).replace("HANGING", hanging)
    text = text.replace("LOWERING", lowering)
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


def test_a_stone_that_is_recognised_from_the_way_up_gets_no_scan_of_its_own(command_line, tmp_path):
    answer = rehearsed(
        command_line, tmp_path,
        "  NoStoneLeft: [failure, success]", "  SelectLargest: success", "  FindFreeSlots: success",
        "  RelocateAndRealign: success", "  DetectSlip: success", "  VerifyPlacement: success",
        "expect:", f"  visited: [look_back, {SEEN}/0:RelocateAndRealign]",
        f"  not_visited: [{SEEN}/1:sequence, look_again]",
    )  # fmt: skip
    assert answer.status == 0, answer.err


def test_a_stone_that_is_in_doubt_gets_a_scan_of_its_own(command_line, tmp_path):
    answer = rehearsed(
        command_line, tmp_path,
        "  NoStoneLeft: [failure, success]", "  SelectLargest: success", "  FindFreeSlots: success",
        "  RelocateAndRealign: [failure, success]", "  DetectSlip: success",
        "  VerifyPlacement: success", "  ForgetPlace: success",
        "expect:", f"  visited: [{SEEN}/1:sequence/2:RelocateAndRealign]",
        f"  not_visited: [{SEEN}/2:sequence, look_again]",
    )  # fmt: skip
    assert answer.status == 0, answer.err


def test_jaws_that_do_not_open_on_the_way_stop_the_arm(command_line, tmp_path):
    answer = rehearsed(
        command_line, tmp_path,
        "  NoStoneLeft: [failure, success]", "  SelectLargest: success", "  FindFreeSlots: success",
        "  OpenGripper: {status: failure, after: 1 s}", "  DetectSlip: success",
        "  VerifyPlacement: success",
        "expect:", "  visited: [approach, SetAside]", "  not_visited: [CloseGripper, put_down]",
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


def test_a_held_stone_is_looked_at_and_placed(command_line, tmp_path):
    answer = rehearsed(
        command_line, tmp_path,
        "  NoStoneLeft: [failure, success]", "  SelectLargest: success", "  FindFreeSlots: success",
        "  SeeHeld: success", "  DetectSlip: success", "  VerifyPlacement: success",
        "expect:", "  ends: {SeeHeld: [success], LowerUntilDown: [success]}",
        "  visited: [PlanPlacement, VerifyPlacement]", "  not_visited: [let_go]",
    )  # fmt: skip
    assert answer.status == 0, answer.err


def test_a_stone_that_lies_otherwise_in_the_jaws_is_set_down_and_grasped_anew(
    command_line, tmp_path
):
    answer = rehearsed(
        command_line, tmp_path,
        "  NoStoneLeft: [failure, success]", "  SelectLargest: success", "  FindFreeSlots: success",
        "  SeeHeld: [failure, success]", "  DetectSlip: success", "  VerifyPlacement: success",
        "expect:", "  ends: {SeeHeld: [failure, success], LowerUntilDown: [success]}",
        "  visited: [let_go, look_again, PlanPlacement, VerifyPlacement]",
    )  # fmt: skip
    assert answer.status == 0, answer.err


@pytest.mark.parametrize("neighbours", ["success", "{status: failure, reason: stone 2 is off}"])
def test_the_neighbours_are_looked_at_after_each_placement(command_line, tmp_path, neighbours):
    answer = rehearsed(
        command_line, tmp_path,
        "  NoStoneLeft: [failure, success]", "  SelectLargest: success", "  FindFreeSlots: success",
        "  DetectSlip: success", "  VerifyPlacement: success", f"  CheckPlaced: {neighbours}",
        "expect:", "  visited: [put_down, CheckPlaced]", "  not_visited: [look_again, SetAside]",
    )  # fmt: skip
    assert answer.status == 0, answer.err


def test_a_stone_for_which_the_ground_never_comes_is_set_down_below(command_line, tmp_path):
    answer = rehearsed(
        command_line, tmp_path,
        "  NoStoneLeft: [failure, success]", "  SelectLargest: success", "  FindFreeSlots: success",
        "  LowerUntilDown: {status: failure, reason: not met}", "  HasArrived: success",
        "  DetectSlip: success", "  IsHolding: success",
        "expect:", "  visited: [let_go, PlanSetDown, look_again]",
        "  not_visited: [VerifyPlacement]",
    )  # fmt: skip
    assert answer.status == 0, answer.err


@pytest.mark.parametrize(
    ("arrivals", "placed"),
    [
        ("[failure, success, success]", True),  # it slips above its place
        ("[failure, success, failure]", False),  # it falls while it is lowered there
        ("failure", False),  # it slips elsewhere
    ],
)
def test_a_stone_that_slips_above_its_place_is_set_down_there(
    command_line, tmp_path, arrivals, placed
):
    at_place, elsewhere = "carry_down/0:sequence/1:LowerUntilDown, VerifyPlacement", "let_go"
    visited, other = (at_place, elsewhere) if placed else (f"{elsewhere}, look_again", at_place)
    answer = rehearsed(
        command_line, tmp_path,
        "  NoStoneLeft: [failure, success]", "  SelectLargest: success", "  FindFreeSlots: success",
        "  TrialLift: success", "  SeeHeld: success", "  DetectSlip: [success, failure]",
        f"  HasArrived: {arrivals}", "  IsHolding: success", "  IsHanging: failure",
        "  VerifyPlacement: success",
        "expect:", f"  visited: [{visited}]", f"  not_visited: [{other}]",
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
