"""Two leaves that drive the same part of the machine are refused in one parallel."""

from typing import Any

import pytest

from executive.interfaces.robot import Robot
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.claims import Part, common
from executive.leaf.outcome import Outcome, succeeded
from executive.tree.problem import MissionFileError


def leaves() -> dict[str, type]:
    class Drive(Action):
        def run(self) -> Steps[None]:
            yield None
            return succeeded()

    class Swing(Drive):
        claims = (Part.CABIN, Part.ARM)

    class Reach(Drive):
        claims = (Part.ARM,)

    class Grip(Drive):
        claims = (Part.JAWS,)

    class Undeclared(Drive):
        needs = (Robot,)

    class Reading(Condition):
        needs = (Robot,)
        claims = ()

        def check(self) -> Outcome[None]:
            return succeeded()

    return {one.__name__: one for one in (Swing, Reach, Grip, Undeclared, Reading)}


def problems(load: Any, children: str, more: str = "") -> list[str]:
    try:
        load(f"trees:\n  main:\n    parallel:\n{children}{more}", leaves=leaves())
    except MissionFileError as error:
        return [f"{problem.mark.line}: {problem.message}" for problem in error.problems]
    return []


CURE = (
    "and a 'parallel' runs them at the same time: put them into a sequence, or choose one with "
    "'if' and 'then' or 'switch'"
)


@pytest.mark.parametrize(
    ("second", "told"),
    [
        ("{run: Reach}", f"Swing and Reach both drive the arm, {CURE}"),
        ("{run: Swing}", f"two Swing drive the cabin and the arm, {CURE}"),
        ("{run: Undeclared}", f"Swing and Undeclared both drive the cabin and the arm, {CURE}"),
        ("{sequence: [{run: Grip}, {run: Reach}]}", f"Swing and Reach both drive the arm, {CURE}"),
        ("{wait: 1 s, on_failure: {run: Reach}}", f"Swing and Reach both drive the arm, {CURE}"),
        ("{call: other}", f"Swing and Reach both drive the arm, {CURE}"),
    ],
)
def test_two_that_drive_the_same_part_are_refused_at_the_second(
    load: Any, second: str, told: str
) -> None:
    found = problems(
        load, f"      - run: Swing\n      - {second}\n", "  other: {retry: 2, do: {run: Reach}}\n"
    )
    assert found[:1] == [f"8: {told}"]
    assert len(found) == 1


@pytest.mark.parametrize("second", ["{run: Grip}", "{check: Reading}", "{wait: 1 s}"])
def test_what_drives_another_part_or_nothing_may_run_beside(load: Any, second: str) -> None:
    assert problems(load, f"      - run: Swing\n      - {second}\n") == []


def test_each_child_that_drives_what_one_before_it_drives_is_told(load: Any) -> None:
    children = "      - run: Reach\n      - run: Grip\n      - run: Swing\n      - run: Reach\n"
    assert [line.partition(", and")[0] for line in problems(load, children)] == [
        "9: Reach and Swing both drive the arm",
        "10: two Reach drive the arm",
    ]


def test_one_after_the_other_they_are_not_refused(load: Any) -> None:
    assert problems(load, "      - sequence: [{run: Swing}, {run: Reach}]\n") == []


def test_the_whole_machine_overlaps_with_each_part() -> None:
    assert common((Part.MACHINE,), (Part.JAWS,)) == (Part.JAWS,)
    assert common((Part.JAWS,), (Part.MACHINE,)) == (Part.JAWS,)
    assert common((Part.JAWS,), (Part.ARM,)) == ()
