"""The machine that holds, and a monitor that watches made-up holds."""

import numpy as np
import pytest
from executive_plugins.monitoring.hold_state import HoldState
from executive_plugins.monitoring.payload_scale import PayloadScale

from executive.machine.machine import Machine, load_machine
from executive.messages.ground_below import GroundBelow
from tests.plugins.monitoring.carries import Carry


@pytest.fixture(scope="module")
def machine() -> Machine:
    return load_machine("m545")


@pytest.fixture(scope="module")
def scale(machine: Machine) -> PayloadScale:
    return PayloadScale(machine)


@pytest.fixture
def watch(machine: Machine, scale: PayloadScale):
    """Return a function from a carry to the verdicts on it, and the monitor."""

    def watched(
        carry: Carry,
        seed: int = 0,
        kind: type[HoldState] = HoldState,
        carried_s: float = np.inf,
        below: GroundBelow | None = None,
    ):
        monitor = kind(kind.Settings(), machine)
        monitor.start()
        monitor.begin_hold()
        told = []
        for one in carry.samples(machine, scale, seed):
            if one.stamp_s > carried_s:
                monitor.begin_carry()
                carried_s = np.inf
                if below is not None:
                    monitor.carry_over(below)
            told.append(monitor.update(one))
        return [verdict for verdict in told if verdict is not None], monitor

    return watched
