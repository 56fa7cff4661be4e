"""A stone falls, or slips, in mid-carry: the shipped trees let go of it or set it down, look again,
and place it in the end.

The faults are made in the simulated world, between ticks; no part of the product knows of them.
"""

from abc import ABC, abstractmethod

import pytest

from executive.events.stone import StoneGrasped
from executive.messages.command import MoveJaws

pytestmark = pytest.mark.mission

CARRIED_S = 9.0  # after the grasp: the stone was seen in the jaws, and is on its way
WET = (0.05, 0.005)  # friction of steel on a wet stone: Coulomb's, and torsional [m]
SLIPPED_M = 0.03  # twice what counts as a slip; the stone is still in the jaws
FORCE_N = 20e3


class Fault(ABC):
    """Goes wrong once, in the first carry."""

    seeds: tuple[int, ...]

    def __init__(self):
        self.at_s = None

    def __call__(self, mission):
        grasped = [
            entry.time_s
            for entry in mission.journal.newest
            if isinstance(entry.event, StoneGrasped)
        ]
        if not grasped or mission.clock.now_s() < grasped[0] + CARRIED_S:
            return
        world = mission.services.plugins["robot"].world
        if self.at_s is None:
            self.at_s = mission.clock.now_s()
            self.begin(world)
        self.go_on(world)

    @abstractmethod
    def begin(self, world):
        """Make the fault."""

    @abstractmethod
    def go_on(self, world):
        """Follow it, at this tick and each later one."""


class OpenJaws(Fault):
    """A valve opens the jaws: the stone falls. With this seed the second grasp holds.

    Of 12 to 20 the stone falls with seven, and is placed with six of these; with 12 it is then
    known by 3.3° at the end, with the others by 2.1° at most.
    """

    seeds = (16,)

    def begin(self, world):
        world.move_jaws(MoveJaws(world.machine.jaw.upper, FORCE_N))

    def go_on(self, world):
        pass  # the mission's next command moves the jaws again


class WetStone(Fault):
    """The stone is slippery for as long as it takes to slip by some centimetres.

    Whether it falls before it stands differs between seeds and between processors. On the one on
    which they were chosen it did not with 8, 1 and 3. With 8 and 1 the second attempt places it,
    but with 1 it is then known by 8° only, as the thinned lidars show it; with 3 they show the
    stone that was set down as two, and the other one is placed.
    """

    seeds = (8, 1, 3)

    def begin(self, world):
        stone = world.model.body(world.site.stones[0].name)
        first = int(stone.geomadr[0])
        self._geoms = range(first, first + int(stone.geomnum[0]))
        self._dry = world.model.geom_friction[self._geoms].copy()
        self._held_m = self._opening_m(world)
        # Else the numbers of steel decide.
        world.model.geom_priority[self._geoms] = world.model.geom_priority.max() + 1
        world.model.geom_friction[self._geoms, :2] = WET

    def go_on(self, world):
        if self._opening_m(world) < self._held_m - SLIPPED_M:
            world.model.geom_friction[self._geoms] = self._dry
            world.model.geom_priority[self._geoms] = 0

    @staticmethod
    def _opening_m(world):
        return world.machine.gripper.opening_m(world.jaws.position_rad)


@pytest.fixture(scope="module", params=[OpenJaws, WetStone])
def made(request, run_mission):
    """Return a fault, and the mission of the first of its seeds with which it comes as described.

    That is told by the truth of the first grasp: a stone that slips has not fallen.
    """
    for seed in request.param.seeds:
        fault = request.param()
        finished = run_mission("robot.site.stones.count=1", after_tick=fault, seed=seed)
        if finished.report["truth"]["grasps"][0]["dropped"] is (request.param is OpenJaws):
            return fault, finished
    return pytest.fail(f"the fault did not come as described with any of {request.param.seeds}")


@pytest.fixture(scope="module")
def fault(made):
    return made[0]


@pytest.fixture(scope="module")
def finished(made):
    return made[1]


@pytest.fixture
def trouble(fault):
    return {OpenJaws: "drop", WetStone: "slip"}[type(fault)]


def test_the_mission_succeeds_all_the_same(finished, fault):
    assert fault.at_s is not None
    assert (finished.report["outcome"], finished.exit_status) == ("success", 0)


def test_the_stone_is_placed_at_a_later_attempt(finished, trouble):
    """The second one, unless the stone falls once more: that differs between processors."""
    counts = finished.report["counts"]
    assert (counts["picks"], counts["placed"], counts["set_aside"]) == (1, 1, 0)
    assert (counts["attempts"], counts["first_attempt"]) in [(2, 0), (3, 0)]
    (pick,) = finished.report["picks"]
    outcomes = [attempt["outcome"] for attempt in pick["attempts"]]
    assert (outcomes[0], outcomes[-1]) == (trouble, "placed")


def test_the_fault_is_seen_within_two_seconds(finished, fault, trouble):
    first = finished.events("verdict_given")[0]
    assert first["payload"]["trouble"] == trouble
    assert fault.at_s < first["time_s"] < fault.at_s + 2.0


def test_the_motion_is_stopped_in_the_tick_in_which_it_is_seen(finished):
    seen_s = finished.events("verdict_given")[0]["time_s"]
    halted = [
        line["node"].rpartition(":")[2]
        for line in finished.events("node_ended")
        if line["payload"]["status"] == "halted" and line["time_s"] == seen_s
    ]
    leaves = [name for name in halted if name[0].isupper()]  # not the sequence around it
    assert leaves == ["ExecuteTrajectory"]


def test_it_lets_go_looks_again_and_takes_the_stone_anew(finished):
    carry = ["attempt_started", "stone_grasped"]
    recovery = ["stone_let_go", "place_forgotten", "stone_sought_again"]
    placed = ["stone_released", "stone_realigned"]
    events = finished.events(*carry, *recovery, *placed)
    # A look from the way up may leave it in doubt; the scan that follows does not.
    told = [line["kind"] for line in events if line["payload"].get("accepted", True)]
    end = told.index("stone_released")
    told[end:] = [kind for kind in told[end:] if kind != "place_forgotten"]  # for that scan
    _join(told, recovery[1:])
    again = finished.report["counts"]["attempts"] - 1
    assert told == [*[*carry, *recovery] * again, *carry, *placed]


def _join(told, look):
    """Make looks that follow each other one: where no grasp is found, the tree looks once more."""
    for i in reversed(range(len(told) - 2 * len(look) + 1)):
        if told[i : i + 2 * len(look)] == look * 2:
            del told[i : i + len(look)]


def test_it_is_found_as_the_stone_that_it_is(finished):
    """One that has turned as it left the jaws is found by a segment, which replaces its model."""
    sought = [event["payload"] for event in finished.events("stone_sought_again")]
    assert sought
    for again in sought:
        assert (again["stone"], again["seen"]) == (1, [1])
        assert again["method"] in {"registration", "segmentation"}


def test_only_a_stone_that_is_still_held_is_set_down(finished, trouble):
    is_held = trouble == "slip"
    # Asked before the way down is planned, while the gripper is lowered, and again before what
    # still hangs is lowered until it stands.
    let_go_s = finished.events("stone_let_go")[0]["time_s"]
    asked = finished.endings("IsHolding", to_s=let_go_s)
    assert asked == (["success"] * 3 if is_held else ["failure"] * 2)
    assert finished.endings("PlanSetDown", to_s=let_go_s) == (["success"] if is_held else [])


def test_the_simulator_saw_the_same(finished, trouble, check_truth):
    grasps = finished.report["truth"]["grasps"]
    assert (grasps[0]["lifted"], grasps[-1]["lifted"]) == (True, True)
    assert [grasps[0]["dropped"], grasps[-1]["dropped"]] == [trouble == "drop", False]
    check_truth(finished, placed=1)
