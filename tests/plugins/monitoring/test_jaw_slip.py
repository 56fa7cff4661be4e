"""Made-up encoder series: silence over good holds, a word about bad ones."""

import numpy as np
import pytest
from executive_plugins.monitoring.jaw_slip import JawSlip
from executive_plugins.monitoring.settings import JawSlipSettings

from executive.arrays import Float
from executive.machine.machine import Machine, load_machine
from executive.messages.joints import JointSample
from executive.messages.verdict import Trouble, Verdict

NOISE_RAD = 5e-4  # more than twice the encoder's
RATE_HZ = 100
OPENING_M = 0.8


@pytest.fixture(scope="module")
def machine() -> Machine:
    return load_machine("m545")


def watch(
    machine: Machine, openings_m: Float, lift_s: float = 2.0, seed: int = 0
) -> Verdict | None:
    """Feed one hold; the arm moves from a time on. Nothing may follow a verdict."""
    monitor = JawSlip(JawSlipSettings(), machine)
    monitor.begin_hold()
    verdicts = [monitor.update(sample) for sample in samples(machine, openings_m, lift_s, seed)]
    told = [verdict for verdict in verdicts if verdict is not None]
    assert len(told) <= 1
    return told[0] if told else None


def samples(machine: Machine, openings_m: Float, lift_s: float, seed: int) -> list[JointSample]:
    rng = np.random.default_rng(seed)
    arm = machine.posture("carry")
    series = []
    for i, opening_m in enumerate(openings_m):
        jaw = machine.gripper.jaw_rad(opening_m) + rng.normal(0, NOISE_RAD)
        velocity = rng.normal(0, 2e-3, len(arm) + 1)
        velocity[1] += 0.2 * (i / RATE_HZ > lift_s)
        series.append(
            JointSample(
                i / RATE_HZ,
                machine.joint_names,
                np.append(arm, jaw),
                velocity,
                np.zeros(len(arm) + 1),
            )
        )
    return series


def hold(duration_s: float) -> Float:
    return np.full(int(duration_s * RATE_HZ), OPENING_M)


@pytest.mark.parametrize("seed", range(5))
def test_says_nothing_over_two_minutes_of_noise(machine: Machine, seed: int) -> None:
    assert watch(machine, hold(120.0), seed=seed) is None


def test_says_nothing_while_a_lifted_stone_settles_by_a_quarter_of_a_metre(
    machine: Machine,
) -> None:
    openings = hold(30.0)
    t = np.arange(len(openings)) / RATE_HZ
    openings -= 0.25 * np.clip((t - 2.2) / 0.5, 0, 1)
    assert watch(machine, openings) is None


def test_says_nothing_about_creep_of_a_millimetre_a_second(machine: Machine) -> None:
    openings = hold(40.0)
    assert watch(machine, openings - 1e-3 * np.arange(len(openings)) / RATE_HZ) is None


def test_tells_a_slip_of_two_centimetres_in_the_carry_within_a_second(machine: Machine) -> None:
    openings = hold(30.0)
    t = np.arange(len(openings)) / RATE_HZ
    verdict = watch(machine, openings - 0.02 * np.clip((t - 20.0) / 0.3, 0, 1))
    assert verdict is not None
    assert verdict.trouble is Trouble.SLIP
    assert 20.0 < verdict.stamp_s < 21.0
    assert "jaws 0.78" in verdict.detail


def test_tells_slow_slip_in_the_end(machine: Machine) -> None:
    openings = hold(60.0)
    verdict = watch(machine, openings - 2e-3 * np.arange(len(openings)) / RATE_HZ)
    assert verdict is not None
    assert verdict.trouble is Trouble.SLIP


def test_tells_a_large_slip_in_the_lift(machine: Machine) -> None:
    openings = hold(10.0)
    openings[250:] -= 0.35
    verdict = watch(machine, openings)
    assert verdict is not None
    assert verdict.stamp_s < 4.0


def test_tells_jaws_that_snap_shut_empty(machine: Machine) -> None:
    openings = hold(10.0)
    openings[500:] = 0.02
    verdict = watch(machine, openings)
    assert verdict is not None
    assert verdict.trouble is Trouble.EMPTY


def test_is_silent_before_and_after_a_hold_and_starts_anew_with_the_next(machine: Machine) -> None:
    monitor = JawSlip(JawSlipSettings(), machine)
    closing = np.linspace(OPENING_M, 0.02, 300)
    assert not any(monitor.update(sample) for sample in samples(machine, closing, 9.0, 0))
    monitor.begin_hold()
    monitor.end_hold()
    assert not any(monitor.update(sample) for sample in samples(machine, closing, 9.0, 0))
    monitor.begin_hold()
    assert any(monitor.update(sample) for sample in samples(machine, closing, 9.0, 0))
    monitor.begin_hold()
    assert not any(monitor.update(sample) for sample in samples(machine, hold(3.0), 9.0, 0))
