"""Lifts whose outcome is plain."""

from itertools import product

import numpy as np
import pytest
from executive_plugins.grasping.sampling.frames import downward_frames
from executive_plugins.grasping.simulated_lift import FALLEN_M, SimulatedLift
from executive_plugins.physics.belief import belief_of
from executive_plugins.physics.scenario import Scenario

from executive.geometry.pose import pose
from executive.machine.gripper import Gripper

UP = np.array([0.0, 0.0, 1.0])
ABOVE_M = 1.25  # of the palm over the ground: the tips close just above it


def block(height_m: float = 0.7) -> np.ndarray:
    return np.array(list(product((-0.45, 0.45), (-0.45, 0.45), (0.0, height_m))))


def over(x: float = 0.0, height_m: float = ABOVE_M) -> np.ndarray:
    return pose(downward_frames(np.zeros(1))[0], np.array([x, 0.0, height_m]))


def slip_m(
    gripper: Gripper,
    hull: np.ndarray,
    T: np.ndarray,
    friction: float = 0.6,
    scenario: Scenario = "kind",
) -> float:
    contact = belief_of(scenario, gripper).contact(friction)
    return SimulatedLift(gripper, hull, UP, 1500.0).lift(T, 0.6 * gripper.open_rad, contact).slip_m


def test_a_block_between_the_jaws_stays_there(gripper: Gripper) -> None:
    assert slip_m(gripper, block(), over()) < 0.03


def test_jaws_that_close_above_a_block_lift_nothing(gripper: Gripper) -> None:
    assert slip_m(gripper, block(0.3), over(height_m=2.0)) > 0.3


def test_a_pyramid_slips_out_when_there_is_hardly_friction(gripper: Gripper) -> None:
    foot = block()[::2]
    pyramid = np.concatenate([foot * (1.6, 1.2, 0.0), block()[1::2] * (0.2, 1.0, 1.0)])
    slippery = slip_m(gripper, pyramid, over(height_m=1.45), friction=0.05)
    assert slippery > slip_m(gripper, block(), over(), friction=0.6) + 0.1
    assert slippery <= FALLEN_M


def test_the_same_lift_ends_the_same(gripper: Gripper) -> None:
    first = slip_m(gripper, block(), over(0.1))
    assert slip_m(gripper, block(), over(0.1)) == pytest.approx(first, abs=0.0)


def test_a_stone_that_holds_as_a_kind_rehearsal_assumes_slips_out_in_the_wet(
    gripper: Gripper,
) -> None:
    """Its sides lean in by 14°."""
    foot, top = block()[::2], block()[1::2]
    leaning = np.concatenate([foot * (1.3, 1.2, 0.0), top * (0.9, 1.0, 1.0)])
    slips = [
        slip_m(gripper, leaning, over(), belief_of(believed, gripper).middle, believed)
        for believed in ("kind", "nominal", "wet")
    ]
    assert slips[0] < 0.03
    assert min(slips[1:]) > 0.3
