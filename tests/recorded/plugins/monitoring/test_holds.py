"""Monitors over holds in exact steps of time, so that spans and limits are met exactly."""

import numpy as np
import pytest
from executive_plugins.monitoring.jaw_slip import JawSlip
from executive_plugins.monitoring.payload_drop import PayloadDrop
from executive_plugins.monitoring.payload_scale import PayloadScale
from executive_plugins.monitoring.settings import JawSlipSettings, PayloadDropSettings
from executive_plugins.monitoring.signal_filters import LowPass, RunningMedian

from executive.messages.joints import JointSample

STEP_S = 1 / 16
TIMES = {"window": 1.0, "lift_settle": 0.5, "confirm": 0.25}


def sample(
    machine, stamp_s: float, jaw_rad: float, moving: float = 0.0, effort=None
) -> JointSample:
    arm = machine.posture("carry")
    velocity = np.append(np.full(len(arm), moving), 0.0)
    efforts = np.zeros(len(arm) + 1) if effort is None else np.append(effort, 0.0)
    return JointSample(stamp_s, machine.joint_names, np.append(arm, jaw_rad), velocity, efforts)


def test_medians(recorded) -> None:
    told = []
    for span_s in (0.25, 0.3):
        median = RunningMedian(span_s)
        told += [median.add(k * STEP_S, float((7 * k) % 5)) for k in range(12)]
    recorded(told)


def test_low_pass(recorded) -> None:
    low_pass = LowPass(0.5)
    stamps = (1.0, 1.25, 1.25, 1.0, 2.0)
    recorded([low_pass.add(t, np.array([t * k, -k])) for k, t in enumerate(stamps)])


def openings(machine, told_m: list[float]) -> list[float]:
    """Return jaw angles for which the tips are open by so much [m]."""
    angles = np.linspace(0.0, machine.gripper.open_rad, 4001)
    known = np.array([machine.gripper.opening_m(a) for a in angles])
    return [float(np.interp(m, known, angles)) for m in told_m]


@pytest.mark.parametrize("lifts_at", [0, 8, 99])
@pytest.mark.parametrize("closing", [(0.5, 0.25), (0.5, 0.4), (0.9, 0.88), (0.5, 0.05)])
def test_slips(recorded, machine, closing, lifts_at) -> None:
    told = []
    for steps in (1, 6, 20):
        # Limits that the jaws' two openings meet exactly, just miss and exceed.
        first, last = openings(machine, list(closing))
        of = machine.gripper.opening_m
        closed = of(first) - of(last)
        for share in (1.0, 0.999, 1.001):
            limits = {"slip": closed * share, "creep": closed * share, "lift_slip": closed * share}
            monitor = JawSlip(JawSlipSettings(**TIMES, **limits, empty=of(last) * share), machine)
            before = monitor.update(sample(machine, 0.0, first))
            monitor.begin_hold()
            jaws = [first] * 14 + list(np.linspace(first, last, steps + 1)[1:]) + [last] * 20
            for k, jaw in enumerate(jaws):
                moving = 0.02 if k < lifts_at else 0.021
                told.append(monitor.update(sample(machine, k * STEP_S, jaw, moving)))
            monitor.end_hold()
            told += [before, monitor.update(sample(machine, 9.0, last))]
    recorded([(k, one) for k, one in enumerate(told) if one is not None])


def test_a_slip_that_ends_is_forgotten(recorded, machine) -> None:
    wide, narrow = openings(machine, [0.6, 0.5])
    monitor = JawSlip(JawSlipSettings(**TIMES, slip=0.05, creep=0.05), machine)
    monitor.begin_hold()
    jaws = [wide] * 20 + [narrow] * 3 + [wide] * 20 + [narrow] * 12
    told = [monitor.update(sample(machine, k * STEP_S, j, 0.1)) for k, j in enumerate(jaws)]
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


@pytest.mark.parametrize(
    "changed",
    [
        {},
        {"carried": 1000.0},
        {"loss": 0.9},
        {"sudden": 0.5},
        {"touch_down": 0.0},
        {"jaw_closing": 0.2},
        {"confirm": 0.0},
    ],
)
def test_drops(recorded, machine, changed) -> None:
    """Lifted, then lost at once or slowly, at rest, sinking or pressing, with and without jaws."""
    settings = PayloadDropSettings(**{"smoothing": 0.125, "confirm": 0.25, "sudden": 2.0} | changed)
    full, half, none, pressing = weights(machine, [1000.0, 480.0, 0.0, -300.0])
    wide, narrow = openings(machine, [0.6, 0.5])
    told = []
    for name, efforts in {
        "dropped": [full] * 30 + [none] * 20,
        "slowly": [full] * 30 + [half] * 40 + [none] * 20,
        "back": [full] * 30 + [none] * 3 + [full] * 20 + [none] * 12,
        "pressed": [full] * 30 + [pressing] * 20,
        "light": [half] * 30 + [none] * 20,
    }.items():
        for sinks, closes in ((False, False), (True, False), (True, True)):
            monitor = PayloadDrop(settings, machine)
            monitor.start()
            monitor.update(sample(machine, 0.0, wide))
            monitor.begin_hold()
            for k, effort in enumerate(efforts):
                moving = np.zeros(len(effort))
                if sinks and k < 28:
                    moving[machine.arm_names.index("J_BOOM")] = 0.05
                jaw = narrow if closes and k > 30 else wide
                shaking = 9.0 if k == 10 else 0.0
                one = sample(machine, k * STEP_S, jaw, 0.0, effort)
                one = JointSample(
                    one.stamp_s, one.names, one.position, np.append(moving + shaking, 0), one.effort
                )
                verdict = monitor.update(one)
                if verdict is not None:
                    told.append((name, sinks, closes, k, verdict))
            monitor.end_hold()
    recorded(told)
