"""Motions that begin or end within the machine itself, or beyond the range of its cabin."""

import numpy as np
import pytest
from executive_plugins.motion.forward_kinematics import link_frames
from executive_plugins.motion.hermite import Hermite
from executive_plugins.motion.self_collision import SelfCollision, machine_bodies
from executive_plugins.motion.settings import HermiteSettings

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine
from executive.messages.cloud import Cloud
from executive.messages.request import MoveRequest, PostureRequest

M545 = load_machine("m545")
NOTHING = Cloud("map", np.zeros((0, 3)))
SCAN = M545.posture("scan")
JAW_RAD = 0.3
# The boom is up, and dipper and telescope are drawn in as far as they go: jaw and cabin touch.
FOLDED = np.array([*SCAN[:1], M545.upper[1], *M545.lower[2:4], *SCAN[4:]])


def asked(start: Float, goal: Float) -> PostureRequest:
    return PostureRequest(start, goal, np.eye(4), NOTHING, None, JAW_RAD)


def first_too_near(way: Float, clearance_m: float) -> int:
    """Return the number of the first posture at which the machine is too near to itself."""
    check = SelfCollision(M545, machine_bodies(M545), clearance_m)
    hit = check.first_hit(link_frames(M545, way, JAW_RAD))
    assert hit is not None
    return hit[0]


def bounded(range_rad: float) -> Machine:
    """Return a machine whose cabin turns by so much to each side."""
    turn = M545.joints[0].model_copy(update={"kind": "revolute", "range": (-range_rad, range_rad)})
    made = M545.model_copy(update={"joints": (turn, *M545.joints[1:])})
    for derived in ("lower", "upper"):  # a copy keeps what the original has derived
        vars(made).pop(derived, None)
    return made


def test_a_motion_that_begins_where_the_machine_touches_itself_is_refused(make_planner) -> None:
    planner = make_planner("m545")
    there = Kinematics(M545).gripper(SCAN)
    move = planner.move(MoveRequest(FOLDED, there, np.eye(4), 0.0, 0.0, NOTHING, None, JAW_RAD))
    posture = planner.move_joints(asked(FOLDED, SCAN))
    for plan in (move, posture):
        assert plan.trajectory is None
        assert plan.reason.startswith("start: collision of jaw_left with cabin")


def test_a_motion_that_ends_where_the_machine_touches_itself_is_refused(make_planner) -> None:
    plan = make_planner("m545").move_joints(asked(SCAN, FOLDED))
    assert plan.trajectory is None
    assert plan.reason.startswith("goal: collision of jaw_left with cabin")


def test_an_arm_that_is_closer_to_itself_than_the_clearance_may_leave(make_planner) -> None:
    """It touches nothing; to come that near from elsewhere is refused."""
    way = SCAN + np.linspace(0.0, 1.0, 101)[:, None] * (FOLDED - SCAN)
    first = first_too_near(way, HermiteSettings().machine_clearance)
    assert first < first_too_near(way, 0.0)
    near = way[first]
    planner = make_planner("m545")
    left = planner.move_joints(asked(near, SCAN))
    assert left.trajectory is not None, left.reason
    np.testing.assert_allclose(left.trajectory.position[-1], SCAN, atol=1e-6)
    come = planner.move_joints(asked(SCAN, near))
    assert come.trajectory is None
    assert come.reason.startswith("goal: collision of")


def test_a_cabin_of_limited_range_swings_within_it_alone() -> None:
    planner = Hermite(HermiteSettings(), bounded(0.5))
    planner.start()
    swung = planner.swing(SCAN, 0.9, 10.0)
    assert swung.trajectory is not None, swung.reason
    assert np.ptp(swung.trajectory.position[:, 0]) == pytest.approx(0.9, abs=1e-3)
    for angle_rad, turn_rad in ((1.1, 0.0), (0.9, 0.1), (0.9, -0.1)):
        start = SCAN + np.append(turn_rad, np.zeros(6))
        plan = planner.swing(start, angle_rad, 10.0)
        assert plan.trajectory is None
        assert plan.reason == "sweeping: the range of J_TURN is -0.50 to 0.50 rad"


def test_the_flow_of_oil_slows_a_motion_down_only_where_it_is_asked_for() -> None:
    goal = SCAN + np.array([2.0, -0.8, 0.8, 1.0, 0.5, 0.3, 1.0])
    plans = []
    for oil_flow in ("limited", "free"):
        settings = HermiteSettings.model_validate({"oil_flow": oil_flow})
        planner = Hermite(settings, M545)
        planner.start()
        plans.append(planner.move_joints(asked(SCAN, goal)).trajectory)
    taken = np.array([M545.hydraulics.displacement[name] for name in M545.arm_names])
    most = [float((np.abs(one.velocity) @ taken).max()) for one in plans]
    assert most[0] <= 0.85 * M545.hydraulics.pump_flow_m3_s * 1.001
    assert most[1] > 0.85 * M545.hydraulics.pump_flow_m3_s
    np.testing.assert_allclose(plans[0].position[-1], plans[1].position[-1])
    assert plans[0].duration_s > plans[1].duration_s


def test_a_path_is_told_in_the_map_wherever_the_base_stands(make_planner) -> None:
    """From gripper to gripper, whole metres of the base beside it."""
    base = pose(t=np.array([10.0, -3.0, 2.0]))
    goal = SCAN + np.array([0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    here = make_planner("m545").move_joints(asked(SCAN, goal))
    there = make_planner("m545").move_joints(
        PostureRequest(SCAN, goal, base, NOTHING, None, JAW_RAD)
    )
    np.testing.assert_allclose(there.path_map, here.path_map + base[:3, 3], atol=1e-9)
    ends = [Kinematics(M545).gripper(q)[:3, 3] for q in here.trajectory.position[[0, -1]]]
    np.testing.assert_allclose(here.path_map[0], ends[0], atol=1e-6)
    assert np.linalg.norm(here.path_map[-1] - ends[1]) < 0.2
