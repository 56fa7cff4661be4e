"""A start that explains its fixes badly looks for another clock of the receiver."""

import numpy as np
import pytest
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial
from executive_plugins.estimation.start.found import Found
from executive_plugins.estimation.start.settings import WindowStartSettings
from executive_plugins.estimation.start.window_start import WindowStart

NOISE = InertialNoise(1e-3, 1e-2, 1e-6, 1e-5, 0.02, 9.81, 0.005)
ARM = np.array([0.4, 0.2, 0.9])
RATE = 2 * np.pi * 1.7  # of the steps [rad/s]
SWAY_M = np.array([0.05, 0.0, 0.02])  # turned by half a turn, it is as it was half a step ago
FIX_M = 0.01


def walked(late_s: float) -> Found:
    """Return the first state of a pedestrian whose fixes carry late stamps."""
    rng, start = np.random.default_rng(1), WindowStart(WindowStartSettings(), NOISE, 0.1)
    for i in range(400):
        t = i / 100
        force = -SWAY_M * RATE**2 * np.sin(RATE * t) + [0.0, 0.0, 9.81]
        shaken, turned = rng.normal(0.0, 0.1, 3), rng.normal(0.0, 0.01, 3)
        start.add_sample(Inertial(t, turned, force + shaken, 0.01))
        at_s = t - late_s  # of the measurement
        if i % 5 == 0:
            p_map = SWAY_M * np.sin(RATE * at_s) + [at_s, 0.0, 0.0] + ARM
            fix = Fix(t, "top", ARM, p_map + rng.normal(0.0, FIX_M, 3), FIX_M**2 * np.eye(3))
            start.add_fix(fix)
        found = start.state()
        if found is not None and found.has_heading:
            return found
    pytest.fail("no heading")


@pytest.mark.parametrize("late_s", [0.17, -0.17])
def test_a_clock_that_is_off_by_a_part_of_a_step_is_found(late_s: float) -> None:
    _compare(walked(late_s), late_s)


def test_a_clock_that_agrees_is_found_as_well() -> None:
    _compare(walked(0.0), 0.0)


def _compare(found: Found, late_s: float) -> None:
    assert found.clock.offset_s == pytest.approx(late_s, abs=4 * found.clock.std_s)
    assert found.clock.std_s < 0.03
    assert found.fix_scale < 1.6
