"""Monitoring: ten seconds of a steady hold, of a lost stone, and samples out of order."""

from collections.abc import Callable, Iterator, Mapping
from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.interfaces.monitoring import Monitor
from executive.machine.machine import Machine
from executive.messages.ground_below import GroundBelow
from executive.messages.joints import JointSample
from executive.messages.verdict import Verdict
from executive.testing.exercise import Exercise

SAMPLES = 1000  # ten seconds
BOOM = "J_BOOM"


def constant(value: float) -> Float:
    """Return a value that stays, shape (SAMPLES,)."""
    return np.full(SAMPLES, value)


def lost(before: float, after: float) -> Float:
    """Return a value that changes in the middle, shape (SAMPLES,)."""
    return np.where(np.arange(SAMPLES) < SAMPLES // 2, before, after)


def samples(machine: Machine, jaw_rad: Float, boom_effort: Float) -> Iterator[JointSample]:
    """Yield 100 samples a second of an arm at rest in its carrying posture."""
    arm = machine.posture("carry")
    boom = machine.arm_names.index(BOOM) if BOOM in machine.arm_names else 0
    zeros = np.zeros(len(arm) + 1)
    for i in range(SAMPLES):
        effort = zeros.copy()
        effort[boom] = boom_effort[i]
        position = np.append(arm, jaw_rad[i])
        yield JointSample(i / 100, machine.joint_names, position, zeros.copy(), effort)


def feed(monitor: Monitor, machine: Machine, jaw_rad: Float, boom_effort: Float) -> list[Verdict]:
    """Return the verdicts of a monitor over ten seconds."""
    verdicts = (monitor.update(sample) for sample in samples(machine, jaw_rad, boom_effort))
    return [verdict for verdict in verdicts if verdict is not None]


class MonitoringInputs(TypedDict):
    """The joints while a stone is lost."""

    samples: tuple[JointSample, ...]


class MonitoringExercise(Exercise[Monitor, MonitoringInputs]):
    """A hold whose stone is lost in the middle."""

    def inputs(self, machine: Machine) -> MonitoringInputs:
        return {"samples": tuple(samples(machine, lost(0.4, 0.0), lost(2.5e5, 0.0)))}

    def run(self, plugin: Monitor, inputs: MonitoringInputs) -> object:
        plugin.begin_hold()
        told = [plugin.update(sample) for sample in inputs["samples"]]
        plugin.end_hold()
        return told

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[Monitor], object]]:
        first, second = list(samples(machine, constant(0.4), constant(2.5e5)))[:2]

        def held(*stream: JointSample) -> Callable[[Monitor], object]:
            def call(monitor: Monitor) -> object:
                monitor.begin_hold()
                return [monitor.update(sample) for sample in stream]

            return call

        return {
            "a sample twice": held(first, first),
            "a sample out of order": held(second, first),
            "an hour between two samples": held(
                first,
                JointSample(3600.0, first.names, first.position, first.velocity, first.effort),
            ),
            "the end of a hold that never began": lambda monitor: monitor.end_hold(),
            "a carry of a hold that never began": lambda monitor: monitor.begin_carry(),
            "ground below a hold that never began": lambda monitor: monitor.carry_over(
                GroundBelow(np.zeros(2), np.zeros((4, 4)), 0.5)
            ),
            "two holds without an end between them": lambda monitor: (
                monitor.begin_hold(),
                monitor.begin_hold(),
                monitor.update(first),
            ),
        }
