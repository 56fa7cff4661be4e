"""Placing: three stones on level ground, and ground that offers no place."""

from collections.abc import Callable, Mapping
from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.interfaces.placing import PlacementPlanner
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.placement import Slot
from executive.messages.segment import Segment, Segmentation
from executive.messages.stone import Stone, StoneState
from executive.testing.digest import locked
from executive.testing.exercise import Exercise
from executive.testing.exercises.useless_clouds import with_each_cloud

BASE = pose(t=np.array([0.0, 0.0, 0.9]))
HANGING = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
GRIPPER = pose(HANGING, np.array([5.0, 0.0, 1.2]))  # above the stone at (5, 0)
LEVEL = np.array([0.0, 0.0, 1.0, 0.0])


def ground() -> Float:
    """Return level ground, a point each 10 cm [m]."""
    x = np.arange(-9.5, 9.5, 0.1)
    xy = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.column_stack([xy, np.zeros(len(xy))])


def stone_at(x: float, y: float) -> Stone:
    """Return a held ellipsoid whose bottom was on the ground at the grasp."""
    rng = np.random.default_rng(0)
    points = rng.normal(size=(1500, 3))
    points = points / np.linalg.norm(points, axis=1)[:, None] * (0.5, 0.4, 0.3) + (x, y, 0.3)
    middle = points.mean(axis=0)
    return Stone(1, StoneState.HELD, points, middle, pose(t=middle), True)


def site() -> Segmentation:
    """Return the ground and three stones on it."""
    stones = [np.array(stone_at(5.0, y).points_map) for y in (-2.5, 0.0, 2.5)]
    segments = tuple(Segment(i, p, p.mean(axis=0), np.ones(3)) for i, p in enumerate(stones))
    return Segmentation("map", segments, Cloud("map", ground()), LEVEL.copy())


def bare(ground: Cloud) -> Segmentation:
    """Return a ground with nothing on it."""
    return Segmentation("map", (), ground, LEVEL.copy())


class PlacingInputs(TypedDict):
    """A site, a held stone and where the machine stands."""

    segmentation: Segmentation
    stone: Stone
    T_map_gripper: Float
    cloud: Cloud
    T_map_base: Float


class PlacingExercise(Exercise[PlacementPlanner, PlacingInputs]):
    """Five slots, and a way to the first of them, or to a given one where there is none."""

    def inputs(self, machine: Machine) -> PlacingInputs:
        return {
            "segmentation": site(),
            "stone": stone_at(5.0, 0.0),
            "T_map_gripper": locked(GRIPPER),
            "cloud": Cloud("map", ground()),
            "T_map_base": locked(BASE),
        }

    def run(self, plugin: PlacementPlanner, inputs: PlacingInputs) -> object:
        base = inputs["T_map_base"]
        slots = plugin.slots(inputs["segmentation"], base, 5)
        slot = slots[0] if slots else Slot(1, np.array([0.0, 6.0, 0.0]))
        held = inputs["stone"], slot, inputs["T_map_gripper"]
        return slots, plugin.plan(*held, inputs["cloud"], base)

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[PlacementPlanner], object]]:
        stone, slot, cloud = stone_at(5, 0), Slot(1, np.array([6.0, 0, 0])), Cloud("map", ground())
        nowhere = np.full((4, 4), np.nan)
        return {
            **with_each_cloud(lambda p, c: p.slots(bare(c), BASE, 3), "for ground"),
            **with_each_cloud(
                lambda p, c: p.plan(stone, slot, GRIPPER, c, BASE), "for surroundings"
            ),
            "a chassis pose that is not finite": lambda p: p.slots(site(), nowhere, 2),
            "a gripper pose that is not finite": lambda p: p.plan(
                stone, slot, nowhere, cloud, BASE
            ),
            "a slot out of reach": lambda p: p.plan(
                stone, Slot(1, np.array([500.0, 0, 0])), GRIPPER, cloud, BASE
            ),
            "a stone without points": lambda p: p.plan(
                Stone(1, StoneState.HELD, np.empty((0, 3)), np.zeros(3), np.eye(4), False),
                slot,
                GRIPPER,
                cloud,
                BASE,
            ),
        }
