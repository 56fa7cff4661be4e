"""A gripper and a stone at a twentieth of their size: the same choice, at a twentieth of the
distances.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from executive_plugins.grasping.sampled_antipodal import SampledAntipodal
from executive_plugins.grasping.sampled_cnn import SampledCnn
from executive_plugins.grasping.settings import SampledAntipodalSettings, SampledCnnSettings
from pydantic import ValidationError

from executive.arrays import Float
from executive.geometry.rotation import angle_between
from executive.interfaces.motion import MotionPlanner
from executive.machine.gripper import Gripper
from executive.machine.machine import Machine
from executive.messages.grasp import Grasp

SCALE = 0.05
LENGTHS = {
    "size",
    "xyz_m",
    "points_m",
    "palm_com_m",
    "jaw_com_m",
    "pivot_m",
    "corners_m",
    "spans_m",
    "tip_m",
}


def scaled(value: Any, is_length: bool = False) -> Any:
    """Return a description with all its lengths scaled."""
    if isinstance(value, dict):
        return {
            key: scaled(item, is_length or key in LENGTHS | {"grasp_centre_m", "digs_m"})
            for key, item in value.items()
        }
    if isinstance(value, (list, tuple)):
        return [scaled(item, is_length) for item in value]
    return SCALE * value if is_length and isinstance(value, float | int) else value


@pytest.fixture(scope="module")
def small(machine: Machine) -> Machine:
    stance = machine.stance.model_copy(update={"payload_kg": SCALE**3 * machine.payload_kg})
    gripper = Gripper.model_validate(scaled(machine.gripper.model_dump()))
    assert gripper.max_opening_m == pytest.approx(SCALE * machine.gripper.max_opening_m)
    return machine.model_copy(update={"gripper": gripper, "stance": stance})


@pytest.fixture(scope="module")
def scene(make_box: Callable, make_field: Callable) -> tuple[Float, Float]:
    """A slab that is seen better at one end, and a neighbour; no point is on a cell's border, to
    fall either way.
    """
    rng, box = np.random.default_rng(2), make_box((1.3, 0.8, 0.65))
    stone = box[rng.random(len(box)) < np.where(box[:, 0] > 0, 0.9, 0.5)]
    around = np.concatenate([make_field(), make_box((0.5, 0.5, 0.5)) + (0.3, 1.1, 0.0)])
    return stone + rng.normal(0, 0.005, stone.shape), around + rng.normal(0, 0.005, around.shape)


@pytest.mark.parametrize("kind", ["sampled_cnn", "paper"])
def test_a_twentieth_of_everything_gives_the_same_grasps(
    kind: str,
    machine: Machine,
    small: Machine,
    scene: tuple,
    see: Callable,
    free_motion: MotionPlanner,
) -> None:
    def grasps(on: Machine, scale: float) -> tuple[Grasp, ...]:
        if kind == "sampled_cnn":
            planner = SampledCnn(
                SampledCnnSettings(samples=20, scale=scale, rehearsed=0), on, free_motion
            )
        else:
            planner = SampledAntipodal(
                SampledAntipodalSettings(samples=20, scale=scale, rehearsed=0), on, free_motion
            )
        stone, around = scene
        return planner.plan(
            *see(scale * stone, scale * around), np.eye(4), np.random.default_rng(0)
        ).grasps

    large, little = grasps(machine, 1.0), grasps(small, SCALE)
    assert len(large) == len(little) > 1
    for a, b in zip(large, little, strict=True):
        np.testing.assert_allclose(
            b.T_map_gripper[:3, 3] / SCALE, a.T_map_gripper[:3, 3], atol=1e-6
        )
        assert angle_between(a.T_map_gripper[:3, :3], b.T_map_gripper[:3, :3]) < 1e-6
        assert b.costs["enclose_m"] / SCALE == pytest.approx(a.costs["enclose_m"])


def test_a_scale_with_rehearsals_is_refused() -> None:
    with pytest.raises(ValidationError, match="rehearsed: 0"):
        SampledAntipodalSettings(scale=0.5)
