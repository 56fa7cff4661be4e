"""First states: at rest with one and two antennas, refused for each sign of motion, from motion."""

import itertools

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState, propagate
from executive_plugins.estimation.live.layout import ESTIMATE, LIVE, SAMPLE
from executive_plugins.estimation.start.chassis import StandstillDetector, TurnJoint
from executive_plugins.estimation.start.chassis_level import ChassisLevel
from executive_plugins.estimation.start.first_state import FirstState
from executive_plugins.estimation.start.settings import (
    RestSettings,
    StandstillSettings,
    WindowStartSettings,
)
from executive_plugins.estimation.start.window_start import WindowStart

from executive.geometry.rotation import from_rpy
from executive.messages.joints import JointSample

NOISE = InertialNoise(0.01, 0.05, 0.002, 0.003, 0.02, 9.81, 0.01)
ARMS = {"left": np.array([0.5, 0.9, 1.0]), "right": np.array([0.5, -0.9, 1.1])}
R = from_rpy(0.03, -0.05, 0.8)
UP = np.array([0.0, 0.0, 1.0])


def started(
    rest: RestSettings, antennas, chassis=None, *, change=lambda k: (0.0, 0.0, 0.0), turn=0.0
):
    """Return what a start finds over two seconds, with a change of rate, force and fixes."""
    arms = {name: ARMS[name] for name in antennas}
    first, rng, told = FirstState(rest, WindowStartSettings(), arms, NOISE, chassis), None, []
    rng = np.random.default_rng(1)
    for k in range(40):
        t, (rate, force, shift) = k / 32, change(k)
        for name, arm in arms.items() if k % 4 == 0 else ():
            p = R @ arm + (1, 2, 3) + rng.normal(0, 0.005, 3) + (shift, 0, 0)
            first.add_fix(t, name, p, np.eye(3) * 1e-4)
        sample = Inertial(
            t,
            rng.normal(0, 0.001, 3) + (rate, 0, 0),
            R.T @ UP * 9.81 + rng.normal(0, 0.02, 3) + (force, 0, 0),
            1 / 32,
        )
        told.append((first.add_sample(sample, turn), first.waits_for))
    return [(k, found, why) for k, (found, why) in enumerate(told) if found or why]


CHANGES = {
    "none": lambda k: (0.0, 0.0, 0.0),
    "a turn": lambda k: (0.03, 0.0, 0.0),
    "a shake": lambda k: (0.05 * (-1) ** k, 0.0, 0.0),
    "a jolt": lambda k: (0.0, 0.5 * (-1) ** k, 0.0),
    "moving fixes": lambda k: (0.0, 0.0, 0.2 * (k % 8 == 0)),
    "a start in motion": lambda k: (0.05 * (k < 10), 0.0, 0.0),
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("antennas", [("left",), ("left", "right")])
def test_rest(recorded, antennas, change) -> None:
    recorded(started(RestSettings(duration_s=0.75), antennas, change=CHANGES[change]))


def test_turning_cabins(recorded) -> None:
    rest = RestSettings(duration_s=0.75, max_rate_rad_s=0.125)
    recorded([started(rest, ARMS, turn=turn) for turn in (0.124, 0.125, -0.5)])


class Level(ChassisLevel):
    """A chassis whose accelerometer points up in a given direction."""

    def __init__(self, up, accel_bias_m_s2: float) -> None:
        self._up, self.accel_bias_m_s2 = up, accel_bias_m_s2

    def up_imu(self, stamp_s: float):
        return self._up


def test_levels(recorded) -> None:
    told, rest = [], RestSettings(duration_s=0.75)
    for tilt, bias in itertools.product((0.0, 0.004, 0.02), (0.02, 0.005)):
        up = (R @ from_rpy(tilt, 0, 0)).T @ UP
        told.append(started(rest, ARMS, Level(up, bias))[-1])
    told.append(started(rest, ARMS, Level(None, 0.02))[-1])
    recorded(told)


def test_a_chassis(recorded, machine) -> None:
    rng, told = np.random.default_rng(2), []
    settings = StandstillSettings(max_rate_std_rad_s=0.0125, max_force_std_m_s2=0.125)
    turn, names = TurnJoint(machine), machine.joint_names
    told.append((turn.is_known, turn.T_cabin_base(0.0)))
    for rate_std, force_std in ((0.01, 0.1), (0.015, 0.1), (0.01, 0.15)):
        standing = StandstillDetector(settings)
        level = ChassisLevel.of(machine, "imu_base", np.eye(4), turn, standing)
        for k in range(60):
            sign = (-1.0) ** k
            standing.add(
                k / 64, np.full(3, rate_std * sign), np.array([0.1, 0, 9.8]) + force_std * sign
            )
            if k in (48, 49, 59):
                told.append(
                    (standing.is_at_rest(k / 64), standing.force(k / 64), level.up_imu(k / 64))
                )
        told += [standing.is_at_rest(59 / 64 + d) for d in (0.09, 0.11, -0.11)]
        standing.add(2.0, np.zeros(3), np.zeros(3))
        told.append(standing.is_at_rest(2.0))
        q = rng.normal(0, 1, len(names))
        turn.update(JointSample(0.9, names, q, q + 0.3, q))
        told.append((turn.rate_cabin, turn.position_rad, turn.stamp_s, turn.is_known))
        told += [turn.T_cabin_base(t) for t in (0.7, 0.85, 0.9, 0.95, 1.2)]
        told.append(level.up_imu(0.9))
    told.append(ChassisLevel.of(machine, "imu_cabin", np.eye(4), turn, standing))
    told.append(ChassisLevel.of(machine, "nobody", np.eye(4), turn, standing))
    recorded(told)


@pytest.mark.parametrize("misfit", [0.0, 0.3, 3.0])
def test_motion(recorded, misfit) -> None:
    """A drive on a curve whose heading is unknown."""

    start = WindowStart(WindowStartSettings(), NOISE)
    told = []
    sample = Inertial(0.0, np.zeros(3), UP * 9.81, 0.05)
    true = InertialState(sample, np.eye(3), np.ones(3), np.zeros(3), np.zeros(3), np.zeros(3))
    start.add_sample(sample)
    heading = from_rpy(0, 0, 1.1)
    for k in range(1, 100):
        t = k / 20
        rate, force = np.array([0, 0, 0.3]), np.array([1.0, 0.1 * np.sin(k), 9.81])
        sample = Inertial(t, rate, force, 0.05)
        true = propagate(true, sample, 9.81)
        start.add_sample(sample)
        if k % 4 == 0:
            p_map = heading @ (true.p_map_imu + true.R_map_imu @ ARMS["left"])
            wrong = misfit * np.array([np.sin(k), np.cos(2 * k), 0])
            start.add_fix(Fix(t, "left", ARMS["left"], p_map + wrong, 1e-4 * np.eye(3)))
        told.append((k, start.state(), start.waits_for))
    recorded([one for one in told if one[1] is not None] + [told[-1][2]])


def test_the_layout_of_shared_memory(recorded) -> None:
    recorded([str(one.descr) + str(one.itemsize) for one in (SAMPLE, ESTIMATE, LIVE)])
