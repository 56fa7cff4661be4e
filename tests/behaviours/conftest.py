"""A context without a mission: scripted plugins, a clock that steps, everything recorded."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive.leaf.context import Context
from executive.leaf.job import Job
from executive.machine.machine import load_machine
from executive.messages.base_state import BaseState
from executive.messages.joints import JointSample

TICK_S = 0.05


class ReadyJob(Job):
    def __init__(self, value):
        self._value = value

    def is_ready(self):
        return True

    def result(self):
        if isinstance(self._value, Exception):
            raise self._value
        return self._value

    def cancel(self):
        pass


class FakeContext(Context):
    """Plugins are plain objects; joints follow a function of time that a test may set."""

    def __init__(self, **plugins):
        self.plugins = plugins
        self.time_s = 0.0
        self.events = []
        self.shown = {}
        self.holds = []
        self.troubles = []
        self._machine = load_machine("m545")
        self.positions = lambda time_s: [
            self._machine.postures["scan"][n] for n in self._machine.arm_names
        ]
        self.velocities = lambda time_s: np.zeros(len(self._machine.arm_names))
        self.jaw = lambda time_s: 0.9

    def now_s(self):
        return self.time_s

    def use(self, interface):
        return self.plugins[interface.capability]

    def start(self, verb, *args, **kwargs):
        return ReadyJob(verb(*args, **kwargs))

    def rng(self):
        return np.random.default_rng(0)

    def state(self):
        eye = np.eye(4)
        return BaseState(self.time_s, eye, eye, eye, np.zeros(3), np.zeros(3), np.eye(6), "GLOBAL")

    def joints(self):
        position = np.array([*self.positions(self.time_s), self.jaw(self.time_s)])
        velocity = np.array([*self.velocities(self.time_s), 0.0])
        return JointSample(
            self.time_s, self._machine.joint_names, position, velocity, np.zeros(len(position))
        )

    def arm(self):
        return np.array(self.positions(self.time_s))

    def gripper(self):
        T = np.eye(4)
        T[:3, 3] = [5.0, 0.0, 2.0]
        return T

    def machine(self):
        return self._machine

    def begin_hold(self):
        self.holds.append("begin")

    def end_hold(self):
        self.holds.append("end")

    def verdicts(self):
        return tuple(self.troubles)

    def last_failure(self):
        return "no way there"

    def record(self, event):
        self.events.append(event)

    @property
    def notes(self):
        """Return kind and payload of the recorded events."""
        return [(event.kind, event.payload()) for event in self.events]

    def show(self, entity, value):
        self.shown[entity] = value


def finish(leaf, limit_s=60.0, **inputs):
    """Drive an action to its end on a stepping clock."""
    steps, answer = leaf.run(**inputs), None
    try:
        while leaf.context.time_s < limit_s:
            waiting = steps.send(answer)
            answer = waiting.result() if waiting is not None else None
            leaf.context.time_s += TICK_S
    except StopIteration as end:
        return end.value
    raise AssertionError(f"not over after {limit_s} s")


@pytest.fixture
def fakes():
    return SimpleNamespace(Context=FakeContext, finish=finish, TICK_S=TICK_S)
