"""A drive without pressure is told where its motion needs an effort, and a sound one never."""

import numpy as np
import pytest

from executive.geometry.rotation import about_axis
from executive.machine.dynamics import Dynamics
from executive.machine.machine import load_machine
from executive.messages.command import Follow
from executive.messages.joints import JointSample
from executive.messages.trajectory import JointTrajectory
from executive.watch.motion import MotionWatch
from executive.watch.pressure import LOOKS
from executive.watch.rules import Rule

MACHINE = load_machine("m545")
ARM = tuple(MACHINE.arm_names)
START = MACHINE.posture("carry")
TURN = ARM.index(MACHINE.turn_joint)
DYNAMICS = Dynamics(MACHINE)
NOISE = next(iter(MACHINE.sensors_of("encoders"))).effort_noise
LIMITS = np.array([joint.max_effort for joint in MACHINE.joints])
RULES = {"pressure": Rule(do="stop")}
BEGAN_S, TICK_S, LASTS_S = 10.0, 0.05, 4.0
LEVEL = np.eye(4)
FASTER, EVEN = 0.2, 0.4  # [rad/s²], and [rad/s]


def swing(acceleration, speed=0.0):
    """Return a swing at a constant acceleration."""
    times = np.linspace(0.0, LASTS_S, 41)[:, None]
    turns = np.arange(len(ARM)) == TURN
    position = START + turns * (speed * times + acceleration * times**2 / 2)
    return JointTrajectory(ARM, times[:, 0], position, turns * (speed + acceleration * times))


def sample(
    stamp_s,
    path,
    lost=(),
    load_kg=0.0,
    up=LEVEL[2, :3],
    acceleration=FASTER,
    noise=0.0,
    carried=(),
    pressing=0.0,
    falls=("", np.inf),
):
    """Return what a machine measures that is on its path; lost drives have no effort.

    Carried ones measure another share of what they need: the ground carries the gripper. A joint
    that falls since a time is as fast as its drive without effort lets it be.
    """
    q, dq = path.at(stamp_s - BEGAN_S)
    ddq = acceleration * (np.arange(len(ARM)) == TURN)
    efforts = DYNAMICS.efforts(q, dq, ddq, up, load_kg)
    name, since_s = falls
    if stamp_s > since_s:
        joint = (np.array(ARM) == name).astype(float)
        inertia = DYNAMICS.efforts(q, dq, ddq + joint, up, load_kg) - efforts
        dq = dq - joint * (efforts @ joint) / (inertia @ joint) * (stamp_s - since_s)
    efforts[[ARM.index(one) for one in lost]] = 0.0
    for one, share in carried:
        efforts[ARM.index(one)] *= share
    efforts = efforts + noise * NOISE * LIMITS
    jaw_nm = -pressing * MACHINE.gripper.tip_force_n * MACHINE.gripper.tip_radius_m
    joints = [*zip(q, dq, efforts, strict=True), (0.5, 0.0, jaw_nm)]
    return JointSample(stamp_s, MACHINE.joint_names, *np.array(joints).T)


class Watched:
    """A swing, and what is told of it at each tick."""

    def __init__(self, path, T_map_base=LEVEL, **settings):
        self.path, self.stamp_s = path, BEGAN_S
        self.watch = MotionWatch(MACHINE, lambda: T_map_base, **settings)
        self.watch.command(Follow(path), BEGAN_S)

    def ticks(self, count, **measured):
        told = []
        for _ in range(count):
            self.stamp_s += TICK_S
            one = sample(self.stamp_s, self.path, **measured)
            told.append(self.watch.troubles(one, RULES).get("pressure", ""))
        return told

    def all(self, **measured):
        return self.ticks(int(LASTS_S / TICK_S), **measured)


@pytest.mark.parametrize("load_kg", [0.0, 1500.0, MACHINE.payload_kg])
@pytest.mark.parametrize("noise", [-3.0, 0.0, 3.0])
def test_a_sound_drive_is_never_told_whatever_the_jaws_carry(load_kg, noise):
    assert not any(Watched(swing(FASTER)).all(load_kg=load_kg, noise=noise))


@pytest.mark.parametrize("name", ["J_TURN", "J_BOOM", "J_TELE"])
@pytest.mark.parametrize("noise", [-2.9, 2.9])
def test_a_drive_without_effort_is_told_after_three_looks(name, noise):
    one = Watched(swing(FASTER))
    assert not any(one.ticks(20))
    *first, last = one.ticks(LOOKS, lost=(name,), noise=noise)
    assert not any(first)
    assert last.startswith(f"{name} has no effort where its motion needs ")
    assert last.endswith("N" if name == "J_TELE" else "N·m")
    assert one.ticks(1) == [""]  # pressure is back


def test_the_told_effort_is_the_least_that_the_motion_needs():
    one = Watched(swing(FASTER))
    told = one.ticks(20, lost=("J_TURN",))[-1]
    needed = DYNAMICS.efforts(START, 0 * START, FASTER * (np.arange(7) == TURN), LEVEL[2, :3], 0)
    assert float(told.split()[-2]) == pytest.approx(needed[TURN], rel=1e-2)


def test_an_effort_that_passes_zero_is_none_of_its_signs():
    one = Watched(swing(FASTER))
    one.ticks(20)
    for _ in range(5):
        assert not any(one.ticks(LOOKS - 1, lost=("J_TURN",)))
        assert not any(one.ticks(1))


@pytest.mark.parametrize("share", [-0.5, 0.3, 8.0])
def test_where_the_ground_carries_the_gripper_nothing_is_judged(share):
    ground = {"lost": ("J_TELE",), "carried": (("J_BOOM", share),)}
    assert not any(Watched(swing(FASTER)).all(**ground))
    # A boom that measures what it may need tells that nothing else carries the arm.
    heavy = {"lost": ("J_TELE",), "carried": (("J_BOOM", 1.8),)}
    assert any(Watched(swing(FASTER)).all(**heavy))


def raised(by_rad):
    """Return a path on which the boom rises by that, with the dipper out."""
    times = np.linspace(0.0, LASTS_S, 41)[:, None]
    low = START + 0.35 * (np.arange(len(ARM)) == ARM.index("J_DIPPER"))
    rises = by_rad / LASTS_S * (np.arange(len(ARM)) == ARM.index("J_BOOM"))
    low[ARM.index("J_BOOM")] -= 0.2
    return JointTrajectory(ARM, times[:, 0], low + rises * times, np.tile(rises, (41, 1)))


@pytest.mark.parametrize(("pressing", "by_rad"), [(1.0, 0.05), (1.0, 0.3), (0.0, 0.05)])
def test_a_stone_that_the_ground_holds_back_relieves_the_dipper_at_the_foot_of_a_path(
    pressing, by_rad
):
    """In 26120192 a trial lift was told as a loss of pressure: the ground pulled at the stone."""
    one = Watched(raised(by_rad))
    told = one.all(lost=("J_DIPPER",), pressing=pressing, acceleration=0.0)
    is_told = [bool(text) for text in told]
    if pressing == 0.0:
        assert any(is_told[:20])
    elif by_rad < 0.1:
        assert not any(is_told)
    else:
        assert not any(is_told[:20])
        assert any(is_told[40:])


def test_jaws_that_a_stone_pushes_up_relieve_the_boom_and_do_not_hide_that_it_falls():
    """In 26134003 of `relocate` they slid up on a stone that widens towards the ground."""
    pushed = {"lost": ("J_BOOM",), "pressing": 1.0, "acceleration": 0.0}
    assert not any(Watched(raised(0.05)).all(**pushed))
    assert any(Watched(raised(0.05)).all(**pushed | {"pressing": 0.0}))
    fallen = Watched(raised(0.05))
    assert not any(fallen.ticks(20, pressing=1.0, acceleration=0.0))
    assert any(fallen.ticks(2 * LOOKS, falls=("J_BOOM", fallen.stamp_s), **pushed))


@pytest.mark.parametrize("name", ["J_EE_PITCH", "J_EE_ROLL", "J_EE_YAW"])
def test_a_drive_that_a_stone_beside_its_grasp_can_relieve_is_not_judged(name):
    assert not any(Watched(swing(FASTER)).all(lost=(name,)))


def test_the_same_sample_counts_once():
    one = Watched(swing(FASTER))
    one.ticks(20)
    again = sample(one.stamp_s + TICK_S, one.path, lost=("J_TURN",))
    assert not any(one.watch.troubles(again, RULES) for _ in range(2 * LOOKS))


def test_an_even_swing_is_judged_where_the_machine_leans_and_not_on_level_ground():
    even = swing(0.0, EVEN)
    lost = {"lost": ("J_TURN",), "acceleration": 0.0}
    assert not any(Watched(even).all(**lost))
    leaning = LEVEL.copy()
    leaning[:3, :3] = about_axis(np.array([1.0, 0.0, 0.0]), 0.4)
    told = Watched(even, leaning).all(up=leaning[2, :3], **lost)
    assert any(one.startswith("J_TURN has no effort") for one in told)
    sound = Watched(even, leaning).all(up=leaning[2, :3], acceleration=0.0)
    assert not any(sound)


def test_where_no_effort_is_needed_now_the_motion_before_is_not_looked_at(monkeypatch):
    """Most samples have a drive without effort, and the efforts of each motion cost the most."""
    asked = []
    efforts = Dynamics.efforts
    watched = Watched(swing(0.0, EVEN))
    watched.ticks(10, acceleration=0.0)
    one = sample(watched.stamp_s + TICK_S, watched.path, lost=("J_TURN",), acceleration=0.0)
    monkeypatch.setattr(Dynamics, "efforts", lambda *a: asked.append(a) or efforts(*a))
    assert "pressure" not in watched.watch.troubles(one, RULES)
    assert len(asked) == 2  # of one of three motions, empty and loaded


def test_without_a_path_a_tilt_or_measured_efforts_nothing_is_judged():
    lost = {"lost": ARM}
    assert any(Watched(swing(FASTER)).all(**lost))
    assert not any(Watched(swing(FASTER), T_map_base=None).all(**lost))
    assert not any(Watched(swing(FASTER), has_efforts=False).all(**lost))
    stopped = Watched(swing(FASTER))
    stopped.watch.stopped()
    assert not any(stopped.all(**lost))
    over = Watched(swing(FASTER))
    over.stamp_s = BEGAN_S + LASTS_S
    assert not any(over.ticks(20, **lost))
    rule = Watched(swing(FASTER))
    rule.ticks(20)
    unasked = [sample(rule.stamp_s + k * TICK_S, rule.path, **lost) for k in range(1, 9)]
    assert not any(rule.watch.troubles(one, {"effort": Rule(do="tell")}) for one in unasked)


def test_until_the_drives_lag_has_passed_and_after_a_break_it_begins_anew():
    lag_s = MACHINE.stance.tracking_lag_s
    one = Watched(swing(FASTER))
    told = one.ticks(20, lost=("J_BOOM",))
    first = next(i for i, text in enumerate(told) if text)
    assert (first + 1 - (LOOKS - 1)) * TICK_S == pytest.approx(lag_s, abs=TICK_S)
    one.watch.stopped()
    assert not any(one.ticks(5, lost=("J_BOOM",)))
    one.watch.command(Follow(one.path), BEGAN_S)
    assert one.ticks(LOOKS, lost=("J_BOOM",))[:-1] == [""] * (LOOKS - 1)
