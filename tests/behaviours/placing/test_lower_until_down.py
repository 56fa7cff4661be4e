"""LowerUntilDown on grounds above and below the expected one."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from executive.behaviours.lower_until_down import LowerUntilDown
from executive.events.stone import StoneTouchedDown
from executive.geometry.pose import pose
from executive.interfaces.motion import MotionPlanner
from executive.machine.kinematics import Kinematics
from executive.messages.request import MotionPlan
from executive.messages.trajectory import JointTrajectory
from executive.messages.weight import Weight
from tests.behaviours.placing.scene import NO_PATH, NO_WAY, SLOTS, placement, plugins

BOOM = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0])


class Arm:
    """An arm that is where its path is, and stands still where it is stopped."""

    def __init__(self, context, start):
        self._context, self._path, self._began_s = context, None, 0.0
        self._still, self.stopped_s = start, []

    def at(self):
        if self._path is None:
            return self._still
        return self._path.at(self._context.time_s - self._began_s)[0]

    def command(self, command):
        self._path, self._began_s = command.trajectory, self._context.time_s

    def stop(self):
        self._still, self._path = self.at(), None
        self.stopped_s.append(self._context.time_s)


@pytest.fixture
def lowering(stage, world):
    """Let the arm follow paths that lower the gripper; 900 kg hang in the jaws above the ground."""

    def lower(
        ground_m,
        weighed=True,
        jolted=lambda payload_kg: payload_kg,
        free_m=1.0,
        up_m=1.0,
        is_placed=True,
        **settings,
    ):
        context = world.leaf_context
        kinematics = Kinematics(context.machine())
        arm = Arm(context, context.machine().posture("carry"))
        offset_m = 2.0 - kinematics.gripper(arm.at())[2, 3]

        def height_m():
            return kinematics.gripper(arm.at())[2, 3] + offset_m

        def move(request):
            """Plan by the boom alone, whose turn by some mrad moves the gripper down, or up."""
            if request.arrive_m > free_m or request.leave_m > up_m:
                return NO_WAY
            goal = minimize_scalar(
                lambda turn: abs(
                    kinematics.gripper(request.start - turn * BOOM)[2, 3]
                    + offset_m
                    - request.T_map_gripper[2, 3]
                ),
                bounds=(-0.2, 0.2),
                method="bounded",
            )
            position = request.start - np.linspace(0.0, goal.x, 20)[:, None] * BOOM
            path = JointTrajectory(
                context.machine().arm_names,
                np.linspace(0.0, 0.5, 20),
                position,
                np.zeros_like(position),
            )
            return MotionPlan(path, "", NO_PATH)

        context.positions = lambda time_s: arm.at()
        context.gripper = lambda: pose(t=np.array([5.0, 0.0, height_m()]))
        context.payload_kg = jolted(lambda: 900.0 if height_m() > ground_m else 40.0)
        context.weighed = Weight(900.0, 20.0) if weighed else None
        world.arm = arm
        plugins(world)["robot"].answers(command=arm.command, stop=arm.stop)
        plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=move)
        planned = placement(SLOTS[0], pose(t=np.array([5.0, 0.0, 1.94]))) if is_placed else None
        given = {"settings": settings} if settings else {}
        return world.tick(LowerUntilDown, hold=world.hold, placement=planned, **given)

    return lower


@pytest.mark.parametrize("ground_m", [1.97, 1.945, 1.83])
def test_a_stone_is_lowered_until_the_ground_carries_it(lowering, world, ground_m):
    """The ground is higher than planned, as planned, and lower.

    A mean over a window of 0.4 s falls to a half within 0.2 s of the touch, while the gripper sinks
    by 1 cm.
    """
    ended = lowering(ground_m)
    assert ended.status == "SUCCESS"
    (event,) = ended.events
    assert isinstance(event, StoneTouchedDown)
    assert event.left_kg == 40.0
    assert ground_m - 1.94 - 0.02 < event.above_m <= ground_m - 1.94
    assert len(world.arm.stopped_s) == 1  # it is stopped on the way, once
    # It sinks by a step of 2 cm in each window of 0.4 s; ramps, weighings and rest take 2 s.
    assert world.arm.stopped_s[0] == pytest.approx((2.0 - ground_m) / 0.05 + 0.8, abs=0.3)


@pytest.mark.parametrize(("ground_m", "status"), [(1.99, "FAILURE"), (1.96, "SUCCESS")])
def test_what_is_met_high_above_the_plan_is_not_its_place(lowering, ground_m, status):
    ended = lowering(ground_m, early=0.035)
    assert ended.status == status
    assert ("it is not at its place" in ended.reason) == (status == "FAILURE")
    assert isinstance(ended.events[0], StoneTouchedDown)


def test_a_stone_that_is_not_at_its_place_hangs_free_again(lowering, world):
    """Monitors take a stone that others carry for one that has fallen."""
    ended = lowering(1.99, early=0.035)
    assert ended.status == "FAILURE"
    assert ended.reason.endswith("it is not at its place")
    assert world.leaf_context.gripper()[2, 3] > 2.0 - 0.002  # where it began, or higher


def test_a_stone_that_cannot_be_raised_again_is_told(lowering, world):
    ended = lowering(1.99, early=0.035, up_m=0.0)
    assert ended.status == "FAILURE"
    assert "it is not at its place, and was not raised off it: no way up" in ended.reason


def test_of_a_way_that_is_not_free_what_is_free_is_gone(lowering, world):
    """No more than 0.1 m at a time are free; of 0.26 m that are a quarter, and so on."""
    ended = lowering(1.83, free_m=0.1)
    assert ended.status == "SUCCESS"
    assert 1.83 - 1.94 - 0.02 < ended.events[0].above_m <= 1.83 - 1.94
    asked = [one["request"].arrive_m for one in plugins(world)["motion"].calls("move")]
    assert asked[:3] == pytest.approx([0.26, 0.13, 0.065])
    assert len(world.arm.stopped_s) == 1


@pytest.mark.parametrize(("ground_m", "status"), [(1.85, "SUCCESS"), (1.7, "FAILURE")])
def test_without_a_placement_the_ground_is_sought_from_where_the_stone_is(
    lowering, ground_m, status
):
    ended = lowering(ground_m, is_placed=False)
    assert (ended.status, ended.events) == (status, [])
    told = "it stands -0.1" if status == "SUCCESS" else "0.20 m below its place"
    assert told in ended.reason


def test_a_stone_that_is_lifted_again_by_a_jolt_is_lowered_on(lowering, world):
    """For 0.3 s nothing is weighed, as if the ground carried it; then it hangs as before."""
    context = world.leaf_context

    def jolted(payload_kg):
        return lambda: 0.0 if 0.8 < context.time_s < 1.1 else payload_kg()

    ended = lowering(1.9, jolted=jolted)
    assert ended.status == "SUCCESS"
    assert ended.events[0].above_m == pytest.approx(1.9 - 1.94, abs=0.02)
    assert len(world.arm.stopped_s) == 2


def test_a_ground_that_never_comes_is_a_failure(lowering):
    ended = lowering(1.0)
    assert ended.status == "FAILURE"
    assert "still hangs in the jaws with 900 ± 0 kg, 0.20 m below its place" in ended.reason
    assert ended.events == []


def test_a_stone_that_is_not_weighed_is_lowered_to_the_plan(lowering, world):
    ended = lowering(1.0, weighed=False)
    assert (ended.status, ended.events) == ("SUCCESS", [])
    assert ended.reason == "no monitor weighs the stone: lowered by 0.06 m to the plan"
    assert world.leaf_context.gripper()[2, 3] == pytest.approx(1.94, abs=1e-4)


def test_a_stone_without_a_way_down_is_not_lowered(lowering, stage, world):
    context = world.leaf_context
    context.weighed, context.payload = Weight(900.0, 20.0), 900.0
    plugins(world)["motion"] = stage.Scripted(MotionPlanner, move=NO_WAY)
    ended = world.tick(LowerUntilDown, hold=world.hold, placement=placement(SLOTS[0]))
    assert (ended.status, ended.reason) == ("FAILURE", "no path down: the boom would hit stone 2")


@pytest.mark.parametrize(("given", "met_m"), [({}, 1.83), ({"stands": 0.8}, 1.9)])
def test_it_stops_at_what_bears_a_part_of_the_stone_where_that_is_asked_for(
    lowering, world, given: dict[str, float], met_m: float
):
    """One end of the stone meets something at 1.9 m, which bears 270 of 900 kg."""
    context = world.leaf_context

    def borne(payload_kg):
        return lambda: min(payload_kg(), 630.0 if context.gripper()[2, 3] < 1.9 else 900.0)

    ended = lowering(1.83, jolted=borne, **given)
    assert ended.status == "SUCCESS"
    assert ended.events[0].above_m == pytest.approx(met_m - 1.94, abs=0.03)
