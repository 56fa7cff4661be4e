"""Made-up effort series of a machine that lifts, carries, sets down, loses."""

import numpy as np
import pytest
from executive_plugins.monitoring.payload_drop import PayloadDrop
from executive_plugins.monitoring.payload_scale import PayloadScale
from executive_plugins.monitoring.settings import PayloadDropSettings

from executive.arrays import Float
from executive.machine.machine import Machine, load_machine
from executive.messages.joints import JointSample
from executive.messages.verdict import Trouble, Verdict

RATE_HZ = 50
HELD_RAD = 0.4


@pytest.fixture(scope="module")
def machine() -> Machine:
    return load_machine("m545")


@pytest.fixture(scope="module")
def scale(machine: Machine) -> PayloadScale:
    return PayloadScale(machine)


class Series:
    """Joint samples of an arm whose boom moves at given speeds while the gripper holds given
    masses.
    """

    def __init__(self, machine: Machine, scale: PayloadScale, seed: int = 0) -> None:
        self._machine, self._scale = machine, scale
        self._rng = np.random.default_rng(seed)
        self._share = next(s.effort_noise for s in machine.sensors_of("encoders"))
        self._limits = np.array(
            [joint.max_effort for joint in machine.joints] + [machine.jaw.max_effort]
        )

    def samples(
        self, mass_kg: Float, boom_rad_s: Float | float = 0.0, jaw_rad: Float | float = HELD_RAD
    ) -> list[JointSample]:
        count = len(mass_kg)
        boom_rad_s, jaw_rad = (np.broadcast_to(v, count) for v in (boom_rad_s, jaw_rad))
        q = self._machine.posture("carry")
        q[1] = 0.6
        series = []
        for i in range(count):
            q[1] += boom_rad_s[i] / RATE_HZ
            series.append(
                self._sample(i / RATE_HZ, np.append(q, jaw_rad[i]), boom_rad_s[i], mass_kg[i])
            )
        return series

    def _sample(self, stamp_s: float, q: Float, boom_rad_s: float, mass_kg: float) -> JointSample:
        effort = np.append(self._scale.empty_effort(q) + mass_kg * self._scale.lever(q[:-1]), 0.0)
        velocity = self._rng.normal(0.0, 2e-3, len(q))
        velocity[1] += boom_rad_s
        effort = effort + self._rng.normal(0.0, self._share * self._limits)
        return JointSample(stamp_s, self._machine.joint_names, q, velocity, effort)


def watch(machine: Machine, series: list[JointSample]) -> Verdict | None:
    monitor = PayloadDrop(PayloadDropSettings(), machine)
    monitor.start()
    monitor.begin_hold()
    told = [verdict for sample in series if (verdict := monitor.update(sample)) is not None]
    assert len(told) <= 1
    return told[0] if told else None


def lifted(duration_s: float, mass_kg: float = 1800.0) -> Float:
    """The weight comes onto the arm between one and two seconds."""
    t = np.arange(int(duration_s * RATE_HZ)) / RATE_HZ
    return mass_kg * np.clip(t - 1.0, 0.0, 1.0)


@pytest.mark.parametrize("seed", range(3))
def test_says_nothing_over_a_minute_of_carrying(
    machine: Machine, scale: PayloadScale, seed: int
) -> None:
    assert watch(machine, Series(machine, scale, seed).samples(lifted(60.0))) is None


def test_says_nothing_over_an_empty_gripper(machine: Machine, scale: PayloadScale) -> None:
    assert watch(machine, Series(machine, scale).samples(np.zeros(1000))) is None


def test_tells_a_drop_within_two_seconds(machine: Machine, scale: PayloadScale) -> None:
    mass = lifted(20.0)
    mass[500:] = 0.0
    verdict = watch(machine, Series(machine, scale).samples(mass))
    assert verdict is not None
    assert verdict.trouble is Trouble.DROP
    assert 10.0 < verdict.stamp_s < 12.0
    assert "of 1" in verdict.detail


def test_tells_nothing_when_the_ground_takes_over_a_stone_that_is_set_down(
    machine: Machine, scale: PayloadScale
) -> None:
    mass = lifted(20.0)
    mass[500:] *= np.clip(1 - np.arange(500) / 25, 0, 1)
    speeds = np.where((np.arange(1000) > 350) & (np.arange(1000) < 490), -0.1, 0.0)
    assert watch(machine, Series(machine, scale).samples(mass, speeds)) is None


def test_tells_nothing_when_the_arm_leans_on_the_ground(
    machine: Machine, scale: PayloadScale
) -> None:
    mass = lifted(20.0)
    mass[500:] = -2500.0
    assert watch(machine, Series(machine, scale).samples(mass)) is None


def test_a_loss_over_many_seconds_is_no_drop(machine: Machine, scale: PayloadScale) -> None:
    """From three quarters of the weight to half of it takes four seconds: longer than `sudden`."""
    mass = lifted(30.0)
    mass[500:] *= np.clip(1 - np.arange(1000) / (16 * RATE_HZ), 0, 1)
    assert watch(machine, Series(machine, scale).samples(mass)) is None


def test_jaws_that_closed_at_the_lift_tell_nothing_about_a_loss_at_the_set_down(
    machine: Machine, scale: PayloadScale
) -> None:
    mass = lifted(20.0)
    mass[500:] *= np.clip(1 - np.arange(500) / 25, 0, 1)
    speeds = np.where((np.arange(1000) > 350) & (np.arange(1000) < 490), -0.1, 0.0)
    jaws = np.where(np.arange(1000) < 100, HELD_RAD + 0.3, HELD_RAD)
    assert watch(machine, Series(machine, scale).samples(mass, speeds, jaws)) is None


def test_tells_a_drop_on_the_way_down_by_the_jaws_that_close(
    machine: Machine, scale: PayloadScale
) -> None:
    mass = lifted(20.0)
    mass[500:] = 0.0
    speeds = np.where(np.arange(1000) > 350, -0.02, 0.0)
    jaws = np.where(np.arange(1000) < 500, HELD_RAD, 0.1)
    verdict = watch(machine, Series(machine, scale).samples(mass, speeds, jaws))
    assert verdict is not None
    assert 10.0 < verdict.stamp_s < 12.0


def test_leaves_out_samples_of_strong_accelerations(machine: Machine, scale: PayloadScale) -> None:
    """Efforts that vanish for a moment while the arm jerks are no drop."""
    mass = lifted(20.0)
    mass[500:550] = 0.0
    speeds = np.zeros(1000)
    speeds[490:560] = 0.4 * np.sin(np.arange(70) / 70 * 6 * np.pi)
    assert watch(machine, Series(machine, scale).samples(mass, speeds)) is None


def test_is_silent_without_a_hold(machine: Machine, scale: PayloadScale) -> None:
    mass = lifted(12.0)
    mass[400:] = 0.0
    monitor = PayloadDrop(PayloadDropSettings(), machine)
    monitor.start()
    assert not any(monitor.update(sample) for sample in Series(machine, scale).samples(mass))
    monitor.begin_hold()
    monitor.end_hold()
    assert not any(monitor.update(sample) for sample in Series(machine, scale).samples(mass))
