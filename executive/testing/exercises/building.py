"""Building: a short wall of boxes on level ground, and inventories that offer nothing."""

from collections.abc import Callable, Mapping
from typing import TypedDict

import numpy as np

from executive.geometry.pose import pose
from executive.interfaces.building import StructurePlanner
from executive.machine.machine import Machine
from executive.messages.building import AsBuilt, StandingStone
from executive.messages.height_grid import HeightGrid
from executive.messages.solid_stone import SolidStone
from executive.messages.structure import Structure
from executive.testing.exercise import Exercise

_FACES = np.array([
    [0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
    [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5],
])  # fmt: skip


def box(name: str, length_m: float, width_m: float, height_m: float) -> SolidStone:
    """Return a box of granite, its sides along x, y and z."""
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    half = np.array([length_m, width_m, height_m]) / 2
    return SolidStone.of_mesh(name, signs * half, _FACES, 2600.0)


def bare() -> AsBuilt:
    """Return a wall of 3 × 0.8 × 0.9 m of which nothing stands, on level ground."""
    line = np.array([[-1.5, 0.0], [1.5, 0.0]])
    ground = HeightGrid.plane(np.array([-4.0, -4.0]), np.array([4.0, 4.0]))
    return AsBuilt(Structure("wall", line, 0.8, 0.9), ground)


def first_course() -> AsBuilt:
    """Return the same with three boxes side by side, 2 cm apart, on all of its length."""
    stones = [
        StandingStone(box(f"foot_{k}", 0.96, 0.7, 0.4), pose(t=np.array([0.98 * (k - 1), 0, 0.2])))
        for k in range(3)
    ]
    return bare().with_standing(*stones)


def boxes() -> tuple[SolidStone, ...]:
    """Return four boxes of 0.14 to 0.22 m³."""
    return tuple(box(f"box_{k}", 0.7 + 0.1 * k, 0.6, 0.35) for k in range(4))


class BuildingInputs(TypedDict):
    """Bare ground and the stones for it."""

    built: AsBuilt
    inventory: tuple[SolidStone, ...]


class BuildingExercise(Exercise[StructurePlanner, BuildingInputs]):
    """The first stone of a wall."""

    def inputs(self, machine: Machine) -> BuildingInputs:
        return {"built": bare(), "inventory": boxes()}

    def run(self, plugin: StructurePlanner, inputs: BuildingInputs) -> object:
        rng = np.random.default_rng(0)
        return plugin.propose(inputs["built"], inputs["inventory"], rng)

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[StructurePlanner], object]]:
        rng = np.random.default_rng
        tower = Structure("needle", np.array([[0.0, 0.0]]), 0.01, 0.01)
        return {
            "an empty inventory": lambda p: p.propose(bare(), (), rng(0)),
            "an envelope smaller than any stone": lambda p: p.propose(
                AsBuilt(tower, bare().ground), boxes(), rng(0)
            ),
            "no time": lambda p: p.propose(bare(), boxes(), rng(0), lambda: False),
        }
