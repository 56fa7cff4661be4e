"""Monitors over holds in exact steps of time, so that spans and limits are met exactly."""

import numpy as np
import pytest
from executive_plugins.monitoring.hold_signals import HoldSignals
from executive_plugins.monitoring.hold_state import HoldState
from executive_plugins.monitoring.payload_scale import PayloadScale
from executive_plugins.monitoring.settings import HoldStateSettings

from executive.messages.joints import JointSample

STEP_S = 1 / 32
TIMES = {"window": 1.0, "lift_settle": 0.5}


def started(monitor: HoldState) -> HoldState:
    """Return the monitor, which holds a stone from now on."""
    monitor.start()
    monitor.begin_hold()
    return monitor


def sample(
    machine, stamp_s: float, jaw_rad: float, moving: float = 0.0, effort=None
) -> JointSample:
    arm = machine.posture("carry")
    velocity = np.append(np.full(len(arm), moving), 0.0)
    efforts = np.zeros(len(arm) + 1) if effort is None else np.append(effort, 0.0)
    return JointSample(stamp_s, machine.joint_names, np.append(arm, jaw_rad), velocity, efforts)


def openings(machine, told_m: list[float]) -> list[float]:
    """Return jaw angles for which the tips are open by so much [m]."""
    angles = np.linspace(0.0, machine.gripper.open_rad, 4001)
    known = np.array([machine.gripper.opening_m(a) for a in angles])
    return [float(np.interp(m, known, angles)) for m in told_m]


@pytest.mark.parametrize("closing", [(0.5, 0.25), (0.5, 0.4), (0.9, 0.88), (0.5, 0.05)])
@pytest.mark.parametrize("lifts_at", [0, 8, 99])
def test_slips(recorded, machine, closing, lifts_at) -> None:
    told = []
    for steps in (1, 6, 20):
        first, last = openings(machine, list(closing))
        of = machine.gripper.opening_m
        closed = of(first) - of(last)
        for share in (1.0, 0.9, 1.1):
            limits = {"slip": closed * share, "creep": closed * share, "lift_slip": closed * share}
            settings = HoldStateSettings(**TIMES, **limits, empty=min(1.0, of(last) * share))
            monitor = started(HoldState(settings, machine))
            jaws = [first] * 24 + list(np.linspace(first, last, steps + 1)[1:]) + [last] * 40
            for k, jaw in enumerate(jaws):
                moving = 0.0 if k < lifts_at else 0.05
                told.append(monitor.update(sample(machine, k * STEP_S, jaw, moving)))
    recorded([(k, one) for k, one in enumerate(told) if one is not None])


def test_scale(recorded, machine) -> None:
    scale, rng, told = PayloadScale(machine), np.random.default_rng(1), []
    for name in sorted(machine.postures):
        q = np.append(machine.posture(name), 0.3)
        velocity = rng.normal(0, 0.1, len(q))
        lever, empty = scale.lever(q[:-1]), scale.empty_effort(q)
        held = JointSample(
            0.0, machine.joint_names, q, velocity, np.append(empty + 1234.5 * lever, 0.0)
        )
        told.append((lever, empty, scale.weigh(held), scale.rise_m_s(held)))
    recorded(told)


def weights(machine, masses: list[float]) -> list[np.ndarray]:
    scale, q = PayloadScale(machine), np.append(machine.posture("carry"), 0.0)
    return [scale.empty_effort(q) + m * scale.lever(q[:-1]) for m in masses]


@pytest.mark.parametrize("changed", [{}, {"slip": 0.2}, {"empty": 0.4}, {"probability": 0.6}])
def test_falls(recorded, machine, changed) -> None:
    """Lifted, then lost at once or slowly, at rest, sinking or pressing; jaws still or slack."""
    settings = HoldStateSettings(**changed)
    full, half, none, pressing = weights(machine, [1000.0, 480.0, 0.0, -300.0])
    wide, wider = openings(machine, [0.5, 0.6])
    told = []
    for name, efforts in {
        "dropped": [full] * 30 + [none] * 20,
        "slowly": [full] * 30 + [half] * 40 + [none] * 20,
        "back": [full] * 30 + [none] * 3 + [full] * 20 + [none] * 12,
        "pressed": [full] * 30 + [pressing] * 20,
    }.items():
        for sinks in (False, True):
            for force, slack, opens in ((0, 0, False), (9e4, 9e4, False), (9e4, 0, True)):
                monitor = started(HoldState(settings, machine))
                for k, effort in enumerate(efforts):
                    moving = -0.05 if sinks and k < 28 else 0.0
                    jaw = wider if opens and k > 30 else wide
                    one = sample(machine, k * STEP_S, jaw, moving, effort)
                    one.effort.flags.writeable = True
                    one.effort[-1] = -(slack if k >= 30 else force)
                    verdict = monitor.update(one)
                    if verdict is not None:
                        told.append((name, sinks, force, slack, k, verdict))
                told.append(monitor.weight())
    recorded(told)


def test_windows(recorded, machine) -> None:
    """All signals of a hold: lifted, carried, lowered, pressed on the ground, and lifted again."""
    settings, rng, told = HoldStateSettings(), np.random.default_rng(8), []
    full, half, none, pressing = weights(machine, [1000.0, 480.0, 0.0, -300.0])
    wide, less = openings(machine, [0.5, 0.47])
    story = [  # effort, jaw, motion of the arm, effort of the jaws, number of samples
        (none, wide, 0.0, 0.0, 9),
        (none, wide, 0.0, 9e4, 9),
        (full, wide, 0.05, 9e4, 16),
        (full, less, 0.0, 7e4, 16),
        (half, less, -0.05, 7e4, 16),
        (none, less, 0.0, 7e4, 110),
        (full, less, 0.05, 9e4, 12),
        (pressing, less, 0.0, 0.0, 110),
    ]
    for noise in (0.0, 0.01):
        signals, k = HoldSignals(settings, machine, PayloadScale(machine)), 0
        for effort, jaw, moving, force, samples in story:
            for _ in range(samples):
                shaken = moving + rng.normal(0.0, noise)
                one = sample(machine, k * STEP_S, jaw, shaken, effort)
                one.effort.flags.writeable = True
                one.effort[-1] = -force * (1 + rng.normal(0.0, noise))
                window, again = signals.add(one), signals.add(one)
                assert again is None  # a sample that is not newer says nothing
                if window is not None:
                    told.append((k, window, signals.weight))
                k += 1
    for first in range(0, len(told), 20):
        recorded(told[first : first + 20])
