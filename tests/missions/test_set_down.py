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
