"""What every monitor must do, whatever it watches."""

from collections.abc import Iterator

import numpy as np
import pytest

from executive import registry
from executive.arrays import Float
from executive.interfaces.monitoring import Monitor
from executive.machine.machine import Machine, load_machine
from executive.messages.joints import JointSample
from executive.messages.verdict import Verdict

SAMPLES = 1000  # ten seconds


@pytest.fixture(scope="module")
def machine() -> Machine:
    return load_machine("m545")


@pytest.fixture(params=[plugin.name for plugin in registry.installed("monitoring")])
def monitor(request: pytest.FixtureRequest, machine: Machine) -> Iterator[Monitor]:
    plugin = registry.load("monitoring", request.param)
    services = {"machine": machine, "rng": np.random.default_rng(0)}
    monitor = plugin(
        plugin.Settings(), *[services[name] for name in registry.dependencies_of(plugin)]
    )
    monitor.start()
    yield monitor
    monitor.close()


def feed(monitor: Monitor, machine: Machine, jaw_rad: Float, boom_effort: Float) -> list[Verdict]:
    arm = machine.posture("carry")
    zeros = np.zeros(len(arm) + 1)
    told = []
    for i in range(SAMPLES):
        effort = zeros.copy()
        effort[machine.arm_names.index("J_BOOM")] = boom_effort[i]
        sample = JointSample(
            i / 100, machine.joint_names, np.append(arm, jaw_rad[i]), zeros, effort
        )
        verdict = monitor.update(sample)
        told += [verdict] if verdict is not None else []
    return told


def constant(value: float) -> Float:
    return np.full(SAMPLES, value)


def lost(before: float, after: float) -> Float:
    return np.where(np.arange(SAMPLES) < SAMPLES // 2, before, after)


def test_it_is_a_monitor(monitor: Monitor) -> None:
    assert isinstance(monitor, Monitor)


def test_says_nothing_about_a_steady_hold(monitor: Monitor, machine: Machine) -> None:
    monitor.begin_hold()
    assert feed(monitor, machine, constant(0.4), constant(2.5e5)) == []


def test_says_once_that_the_stone_is_gone_and_since_when(
    monitor: Monitor, machine: Machine
) -> None:
    monitor.begin_hold()
    told = feed(monitor, machine, lost(0.4, 0.0), lost(2.5e5, 0.0))
    assert len(told) == 1
    assert 5.0 <= told[0].stamp_s <= 8.0
    assert told[0].monitor in [plugin.name for plugin in registry.installed("monitoring")]
    assert told[0].detail


def test_says_nothing_unless_something_is_held(monitor: Monitor, machine: Machine) -> None:
    assert feed(monitor, machine, lost(0.4, 0.0), lost(2.5e5, 0.0)) == []
    monitor.begin_hold()
    monitor.end_hold()
    assert feed(monitor, machine, lost(0.4, 0.0), lost(2.5e5, 0.0)) == []


def test_each_hold_is_judged_anew(monitor: Monitor, machine: Machine) -> None:
    for _ in range(2):
        monitor.begin_hold()
        assert len(feed(monitor, machine, lost(0.4, 0.0), lost(2.5e5, 0.0))) == 1
