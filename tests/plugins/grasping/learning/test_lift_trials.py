"""The errors of simulated lifts: those that are asked for, by default those of the first labels."""

import numpy as np
from executive_plugins.grasping.learning.lift_trials import LiftTrials

from executive.geometry.rotation import angle_between
from executive.machine.machine import load_machine

CORNERS = np.array([[x, y, z] for x in (-0.4, 0.4) for y in (-0.3, 0.3) for z in (0.0, 0.5)])


def errors_of(trials: LiftTrials) -> tuple[float, float]:
    """Return the largest shift along an axis [m] and turn [rad] of many draws."""
    rng = np.random.default_rng(0)
    drawn = [trials.draw(rng).T_gripper_arrived for _ in range(300)]
    shift_m = max(float(np.abs(T[:3, 3]).max()) for T in drawn)
    return shift_m, max(angle_between(np.eye(3), T[:3, :3]) for T in drawn)


def test_errors_reach_to_their_bounds_and_not_beyond() -> None:
    gripper = load_machine("m545").gripper
    for trials, most_m, most_rad in (
        (LiftTrials(gripper, CORNERS), 0.05, np.radians(5.0)),
        (LiftTrials(gripper, CORNERS, "nominal", 0.02, 0.026), 0.02, 0.026),
    ):
        shift_m, turn_rad = errors_of(trials)
        assert 0.98 * most_m < shift_m <= most_m
        assert 0.98 * most_rad < turn_rad <= np.sqrt(3) * most_rad
