"""What every smoother must do, whatever its method."""

import numpy as np

from executive.geometry.pose import inverse
from executive.interfaces.smoothing import TrajectorySmoother
from executive.machine.machine import Machine
from executive.testing.exercises.estimation import T_map_cabin_at_rest, rest
from executive.testing.pytest_plugin import Insist

CAPABILITY = "smoothing"


def test_it_finds_a_machine_at_rest_at_each_inertial_sample(
    plugin: TrajectorySmoother, machine: Machine, insist: Insist
) -> None:
    states = plugin.smooth(rest(machine))
    insist(states, "it knows no state after six seconds at rest")
    stamps = np.array([state.stamp_s for state in states])
    np.testing.assert_allclose(np.diff(stamps), 0.01, atol=1e-9)
    for state in (states[0], states[-1]):
        np.testing.assert_allclose(state.T_map_base, np.eye(4), atol=5e-3)
        T_base_cabin = inverse(state.T_map_base) @ state.T_map_cabin
        np.testing.assert_allclose(T_base_cabin, T_map_cabin_at_rest(machine), atol=1e-6)


def test_an_empty_recording_gives_no_states(plugin: TrajectorySmoother) -> None:
    assert len(plugin.smooth(())) == 0
