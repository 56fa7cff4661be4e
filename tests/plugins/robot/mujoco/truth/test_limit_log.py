"""Limits of a machine that is posed: shares, how often each is passed, and what tips it over."""

import mujoco
import numpy as np
import pytest
from executive_plugins.robot.mujoco.robot import MujocoRobot
from executive_plugins.robot.mujoco.settings import MujocoSettings
from executive_plugins.robot.mujoco.truth.limit_log import LimitLog

from executive.errors import DataError
from executive.interfaces.truth import LimitUse
from executive.machine.dynamics import Dynamics
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.lift_capacity import LiftCapacity
from executive.machine.machine import load_machine

MACHINE = load_machine("m545")
ARM = {joint.name: joint for joint in MACHINE.joints}


def robot(base: str = "welded") -> MujocoRobot:
    settings = MujocoSettings.model_validate(
        {
            "base": base,
            "site": {"stones": {"count": 0}, "terrain": {"half_size_m": 10}},
        }
    )
    made = MujocoRobot(settings, MACHINE, np.random.default_rng(0))
    made.start()
    return made


class Posed:
    """The machine with a log of its limits, put where a test wants it."""

    def __init__(self) -> None:
        self.model = robot().world.model
        self.data = mujoco.MjData(self.model)
        for name, value in zip(MACHINE.arm_names, MACHINE.posture("scan"), strict=True):
            self.data.joint(name).qpos = value
        mujoco.mj_forward(self.model, self.data)
        self.log = LimitLog(MACHINE, self.model)
        self.time_s = 0.0
        self.hold(0.0)

    def hold(self, duration_s: float) -> None:
        """Note what is for a while."""
        for _ in range(round(duration_s / 0.01) + 1):
            self.log.step(self.time_s, self.model, self.data)
            self.time_s = round(self.time_s + 0.01, 6)

    def use(self, kind: str, of: str) -> LimitUse:
        return next(one for one in self.log.found() if (one.kind, one.of) == (kind, of))


@pytest.fixture
def posed() -> Posed:
    return Posed()


def test_a_joint_halfway_to_its_end_has_half_the_share(posed: Posed) -> None:
    joint = ARM["J_DIPPER"]
    posed.data.joint("J_DIPPER").qpos = 0.25 * joint.lower + 0.75 * joint.upper
    posed.hold(0.1)
    found = posed.use("position", "J_DIPPER")
    assert found.largest_share == pytest.approx(0.5, abs=1e-4)
    assert found.times_beyond == 0


def test_a_joint_without_ends_has_no_limit_of_its_place(posed: Posed) -> None:
    endless = {joint.name for joint in MACHINE.joints if joint.range is None}
    bounded = {one.of for one in posed.log.found() if one.kind == "position"}
    assert endless
    assert bounded == set(ARM) - endless


def test_two_times_beyond_a_speed_are_two_and_a_short_gap_is_none(posed: Posed) -> None:
    top = ARM["J_BOOM"].max_velocity
    for speed, duration_s in ((1.1, 0.1), (0.9, 0.1), (-1.2, 0.1), (0.0, 0.5), (1.05, 0.2)):
        posed.data.joint("J_BOOM").qvel = speed * top
        posed.hold(duration_s - 0.01)
    found = posed.use("speed", "J_BOOM")
    assert found.times_beyond == 2  # the first two are 0.1 s apart
    assert found.beyond_s == pytest.approx(0.4, abs=1e-6)
    assert found.largest_share == pytest.approx(1.2)
    assert found.at_s == pytest.approx(0.21, abs=0.011)


def test_the_flow_is_that_of_all_joints_together(posed: Posed) -> None:
    oil = MACHINE.hydraulics
    assert oil is not None
    share = 0.0
    for name in ("J_BOOM", "J_DIPPER"):
        posed.data.joint(name).qvel = 0.5 * ARM[name].max_velocity
        share += 0.5 * ARM[name].max_velocity * oil.displacement[name] / oil.pump_flow_m3_s
    posed.hold(0.1)
    assert posed.use("flow", "pump").largest_share == pytest.approx(share, abs=1e-4)


def test_an_effort_counts_with_the_weight_of_the_links() -> None:
    simulated = robot()
    simulated.read(0.5)
    still = np.zeros(len(MACHINE.joints))
    q = simulated.world.arm.position()
    weight = Dynamics(MACHINE).efforts(q, still, still, np.array([0.0, 0.0, 1.0]), 0.0)
    efforts = [one for one in simulated.limit_log.found() if one.kind == "effort"]
    boom = MACHINE.arm_names.index("J_BOOM")
    told = efforts[boom].largest_share * ARM["J_BOOM"].max_effort
    assert told == pytest.approx(abs(weight[boom]), rel=0.05)  # it has just come to rest


def test_truth_without_limits_is_refused(posed: Posed) -> None:
    with pytest.raises(DataError, match="limits"):
        posed.log.take({}, 0.0)


@pytest.mark.parametrize("base", ["welded", "on_wheels"])
def test_the_load_that_tips_the_machine_has_a_share_of_1(base: str) -> None:
    simulated = robot(base)
    world = simulated.world
    capacity = LiftCapacity(MACHINE).at(world.arm.position())
    hand = world.data.body(MACHINE.gripper_link)
    for share in (0.5, 1.0):
        force = np.array([0.0, 0.0, -share * capacity.tipping_kg * GRAVITY_M_S2])
        R = hand.xmat.reshape(3, 3)
        arm_m = R @ MACHINE.gripper.grasp_centre + hand.xpos - hand.xipos
        world.data.xfrc_applied[hand.id] = np.concatenate([force, np.cross(arm_m, force)])
        simulated.read(world.time_s + 2.0)
        told = simulated.limit_log
        now = told._reaction.share(world.model, world.data)
        assert now == pytest.approx(share, abs=0.02)  # the arm sags a little
    tipping = [one for one in told.found() if one.kind == "tipping"]
    assert tipping[0].largest_share >= now - 1e-4


def test_on_its_legs_an_unloaded_machine_is_held_by_all_its_weight() -> None:
    simulated = robot("on_legs")
    simulated.read(0.5)
    tipping = next(one for one in simulated.limit_log.found() if one.kind == "tipping")
    assert tipping.largest_share < 0.05
    assert tipping.times_beyond == 0


def test_what_one_process_has_noted_another_one_takes(posed: Posed) -> None:
    posed.data.joint("J_BOOM").qvel = 1.5 * ARM["J_BOOM"].max_velocity
    posed.hold(0.3)
    other = LimitLog(MACHINE, posed.model)
    other.take(posed.log.records(), 0.1)
    mine, theirs = posed.log.found(), other.found()
    assert [one.largest_share for one in theirs] == [one.largest_share for one in mine]
    assert [one.times_beyond for one in theirs] == [one.times_beyond for one in mine]
    boom = next(one for one in theirs if (one.kind, one.of) == ("speed", "J_BOOM"))
    assert boom.at_s == pytest.approx(posed.use("speed", "J_BOOM").at_s - 0.1)
