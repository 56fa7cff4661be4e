"""Limits of the joints with what the held stone weighs."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.motion.hermite import Hermite
from executive_plugins.motion.settings import HermiteSettings
from scipy.spatial import ConvexHull

from executive.arrays import Float
from executive.machine.kinematics import Kinematics
from executive.machine.lift_capacity import LiftCapacity
from executive.machine.machine import Machine, load_machine
from executive.machine.sway import Sway
from executive.machine.swayed import swayed
from executive.machine.tipping_moment import TippingMoment
from executive.messages.cloud import Cloud
from executive.messages.request import MoveRequest, PostureRequest
from executive.messages.trajectory import JointTrajectory

M545 = load_machine("m545")
SHARE = HermiteSettings().speed


@pytest.fixture(scope="module")
def planner() -> Hermite:
    started = Hermite(HermiteSettings(load_limits="by_mass"), M545)
    started.start()
    return started


@pytest.fixture(scope="module")
def asked() -> PostureRequest:
    """A turn with a stone, above nothing."""
    start = M545.posture("carry")
    turned = start.copy()
    turned[0] += 1.5
    stone = np.random.default_rng(1).normal([0.8, 0.0, 0.0], 0.1, (50, 3))
    return PostureRequest(start, turned, np.eye(4), Cloud("map", np.zeros((0, 3))), stone, 0.3)


def most(planner: Hermite, asked: PostureRequest) -> tuple[Float, float]:
    plan = planner.move_joints(asked)
    assert plan.trajectory is not None, plan.reason
    return np.abs(plan.trajectory.velocity).max(axis=0), plan.trajectory.duration_s


def test_a_heavier_stone_is_carried_more_slowly(planner: Hermite, asked: PostureRequest) -> None:
    at = {
        share: most(planner, replace(asked, held_kg=share * M545.payload_kg))
        for share in (0.0, 0.5, 1.0)
    }
    assert at[0.0][1] <= at[0.5][1] < at[1.0][1]
    for share, (speeds, _) in at.items():
        limit = (1 - share) * M545.max_velocity + share * M545.loaded_max_velocity
        assert (speeds <= SHARE * limit + 1e-9).all()


def test_an_unknown_mass_has_the_loaded_limits(planner: Hermite, asked: PostureRequest) -> None:
    heavy = replace(asked, held_kg=2 * M545.payload_kg)
    assert most(planner, asked)[1] == most(planner, heavy)[1]


def test_by_default_the_mass_changes_nothing(make_planner, asked: PostureRequest) -> None:
    light = replace(asked, held_kg=100.0)
    assert most(make_planner("m545"), asked)[1] == most(make_planner("m545"), light)[1]


@pytest.mark.parametrize("settings", [{}, {"held_up_m_s2": 0.2, "held_sideways_m_s2": 0.4}])
def test_no_joint_accelerates_a_held_stone_by_more_than_is_set(
    asked: PostureRequest, settings: dict[str, float]
) -> None:
    """Straight up, and around; what the joints add to each other is not limited."""
    chosen, kinematics = HermiteSettings(**settings), Kinematics(M545)
    planner = Hermite(chosen, M545)
    planner.start()
    for plan in (planner.move(raised(asked)), planner.move_joints(asked)):
        assert plan.trajectory is not None, plan.reason
        q, speeds, times_s = (
            getattr(plan.trajectory, n) for n in ("position", "velocity", "times_s")
        )
        accelerations = np.abs(np.diff(speeds, axis=0) / np.diff(times_s)[:, None])
        J = np.array([kinematics.jacobian(one) for one in (q[0], q[-1])])
        up, sideways = np.abs(J[:, 2]).max(axis=0), np.linalg.norm(J[:, :2], axis=1).max(axis=0)
        assert (accelerations * up).max() <= 1.02 * chosen.held_up_m_s2
        assert (accelerations * sideways).max() <= 1.02 * chosen.held_sideways_m_s2


def test_an_empty_gripper_is_raised_faster_than_a_stone(
    make_planner, asked: PostureRequest
) -> None:
    planner, up = make_planner("m545"), raised(asked)
    empty_s, held_s = (
        planner.move(replace(up, held_gripper=held)).trajectory.duration_s
        for held in (None, up.held_gripper)
    )
    assert held_s > 1.1 * empty_s


@pytest.mark.parametrize("held_kg", [500.0, 1500.0, 2800.0])
def test_a_stone_raised_by_a_machine_on_legs_hardly_sways(
    asked: PostureRequest, held_kg: float
) -> None:
    """A load on an undamped spring of the period of its sway; a welded machine sways by more."""
    up = replace(raised(asked, 0.2), held_kg=held_kg)
    period_s = Sway(resting(True)).period_s(asked.start, held_kg)
    on_legs, welded = (swayed_m(raised_by(base, up), period_s) for base in (True, False))
    assert on_legs < 0.01
    assert on_legs < 0.4 * welded


def test_a_stone_that_nobody_has_weighed_sways_as_its_hull_would(asked: PostureRequest) -> None:
    up = raised(asked, 0.2)
    hull_kg = 2700.0 * ConvexHull(up.held_gripper).volume
    unknown, known = (raised_by(True, replace(up, held_kg=kg)) for kg in (None, hull_kg))
    np.testing.assert_array_equal(unknown.times_s, known.times_s)


def test_a_motion_with_a_load_uses_a_part_of_what_holds_the_machine(asked: PostureRequest) -> None:
    """All joints of the boom brake at once at its end; with less load they may do so harder."""
    machine = resting(True)
    down = asked.start + np.array([np.pi / 2, -0.7, 0.5, 0.6, 0.3, 0.0, 0.0])
    start = asked.start + np.pi / 2 * np.eye(len(down))[0]
    tipping_kg = LiftCapacity(machine).at(down).tipping_kg
    used, lasted_s = [], []
    for share in (0.3, 0.85):
        kg = share * tipping_kg
        motion = moved_by(machine, replace(asked, start=start, goal=down, held_kg=kg))
        used.append(used_by(machine, motion, kg))
        lasted_s.append(motion.duration_s)
    assert max(used) <= 0.47
    assert lasted_s[1] > 1.1 * lasted_s[0]


def test_an_empty_arm_far_out_uses_a_part_of_what_holds_the_machine_too(
    asked: PostureRequest,
) -> None:
    """It weighs tonnes itself, and its joints speed up and brake at once, as the machine sways."""
    turned = asked.start + np.pi / 2 * np.eye(len(asked.start))[0]
    far = turned + np.array([0.0, -0.47, 0.86, 1.24, 0.0, 0.0, 0.0])
    above = far + np.array([0.0, 0.31, 0.1, 0.0, 0.25, 0.0, 0.0])
    empty = replace(asked, start=above, goal=far, held_gripper=None)
    used, lasted_s = [], []
    for yields in (True, False):
        motion = moved_by(resting(yields), empty)
        used.append(used_by(resting(True), motion, 0.0))
        lasted_s.append(motion.duration_s)
    assert used[0] <= 0.61 < 1.0 < used[1]
    assert lasted_s[0] > 1.05 * lasted_s[1]


def test_a_load_of_about_the_payload_is_drawn_in_as_far_as_the_payload_asks(
    asked: PostureRequest,
) -> None:
    """At the most that it may weigh, two deviations more, it may be lifted nowhere."""
    machine, turn = resting(True), np.eye(len(asked.start))[0]
    goal = Kinematics(machine).gripper(asked.start + 2.35 * turn)
    request = MoveRequest(
        start=asked.start + 0.64 * turn,
        T_map_gripper=goal,
        T_map_base=np.eye(4),
        leave_m=0.3,
        arrive_m=0.3,
        obstacles=asked.obstacles,
        held_gripper=asked.held_gripper,
        jaw_rad=0.3,
        held_kg=1.05 * machine.payload_kg,
    )
    motion = moved_by(machine, request)
    assert LiftCapacity(machine).along(motion.position).rated_kg > 0.99 * machine.payload_kg


def test_an_empty_gripper_is_not_slowed_by_a_sway(asked: PostureRequest) -> None:
    empty = replace(raised(asked), held_gripper=None)
    assert raised_by(True, empty).duration_s == raised_by(False, empty).duration_s


def used_by(machine: Machine, motion: JointTrajectory, load_kg: float) -> float:
    """Return the share of what holds the machine that a motion takes, with the sway of its end."""
    moments = TippingMoment(machine).along(motion.times_s, motion.position, load_kg)
    period_s = Sway(machine).period_s(motion.position[-1], load_kg)
    pressing_nm = swayed(moments.tipping_nm, moments.step_s, period_s)
    return float((pressing_nm / moments.holding_nm.min(axis=0)).max())


def resting(yields: bool) -> Machine:
    """Return the machine on its legs, or welded."""
    support_n_m = 2e6 if yields else None
    stance = M545.stance.model_copy(update={"support_n_m": support_n_m, "is_free": yields})
    return M545.model_copy(update={"stance": stance})


def raised_by(yields: bool, asked: MoveRequest) -> JointTrajectory:
    """Return the motion of a machine on its legs, or welded."""
    return moved_by(resting(yields), asked)


def moved_by(machine: Machine, asked: MoveRequest | PostureRequest) -> JointTrajectory:
    """Return the motion of a machine."""
    planner = Hermite(HermiteSettings(), machine)
    planner.start()
    plan = planner.move(asked) if isinstance(asked, MoveRequest) else planner.move_joints(asked)
    assert plan.trajectory is not None, plan.reason
    return plan.trajectory


def swayed_m(trajectory: JointTrajectory, period_s: float) -> float:
    """Return the amplitude with which a load on a spring sways after a motion [m]."""
    kinematics, step_s = Kinematics(M545), 0.005
    times_s = np.arange(0.0, trajectory.duration_s, step_s)
    heights_m = [kinematics.gripper(trajectory.at(time_s)[0])[2, 3] for time_s in times_s]
    omega, off_m, speed = 2 * np.pi / period_s, 0.0, 0.0
    for acceleration in np.diff(heights_m, 2) / step_s**2:
        speed -= (omega**2 * off_m + acceleration) * step_s
        off_m += speed * step_s
    return float(np.hypot(off_m, speed / omega))


def raised(asked: PostureRequest, way_m: float = 1.0) -> MoveRequest:
    """Return the way straight up from the start."""
    goal = Kinematics(M545).gripper(asked.start)
    goal[2, 3] += way_m
    return MoveRequest(
        asked.start, goal, np.eye(4), way_m, 0.0, asked.obstacles, asked.held_gripper, asked.jaw_rad
    )
