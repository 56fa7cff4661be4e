"""Grasping: a stone like an egg on level ground, and stones that nothing can hold."""

from collections.abc import Callable, Mapping
from functools import cache
from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.interfaces.grasping import GraspPlanner
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.stone import Stone, StoneState
from executive.testing.digest import locked
from executive.testing.exercise import Exercise
from executive.testing.exercises.useless_clouds import with_each_cloud


def stone_of(points: Float) -> Stone:
    """Return a stone on the ground that was seen from above; its model is these points [m]."""
    middle = points.mean(axis=0) if len(points) else np.zeros(3)
    return Stone(1, StoneState.ON_GROUND, points.copy(), middle, np.eye(4), True)


@cache
def egg() -> tuple[Stone, Cloud]:
    """Return a stone 1.2 m long about (5, 1, 0.4) on level ground, and the cloud of both."""
    i = np.arange(4000) + 0.5
    polar, azimuth = np.arccos(1 - 2 * i / 4000), np.pi * (1 + 5**0.5) * i
    unit = np.column_stack(
        [np.cos(azimuth) * np.sin(polar), np.sin(azimuth) * np.sin(polar), np.cos(polar)]
    )
    stone = unit[unit[:, 2] > -0.7] * (0.62, 0.45, 0.4) + (5.0, 1.0, 0.4)
    xy = np.random.default_rng(0).uniform((1, -3), (9, 5), (15000, 2))
    ground = np.column_stack([xy, np.zeros(len(xy))])
    return stone_of(stone), Cloud("map", np.concatenate([stone, ground]))


class GraspingInputs(TypedDict):
    """A stone, the site around it and where the machine stands."""

    target: Stone
    cloud: Cloud
    T_map_base: Float


class GraspingExercise(Exercise[GraspPlanner, GraspingInputs]):
    """One plan for the egg."""

    def inputs(self, machine: Machine) -> GraspingInputs:
        stone, cloud = egg()
        return {"target": stone, "cloud": cloud, "T_map_base": locked(np.eye(4))}

    def run(self, plugin: GraspPlanner, inputs: GraspingInputs) -> object:
        rng = np.random.default_rng(3)
        return plugin.plan(inputs["target"], inputs["cloud"], inputs["T_map_base"], rng)

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[GraspPlanner], object]]:
        stone, cloud = egg()
        rng, base = np.random.default_rng(0), np.eye(4)
        return {
            **with_each_cloud(lambda p, c: p.plan(stone, c, base, rng), "for surroundings"),
            "a stone without points": lambda p: p.plan(
                stone_of(np.empty((0, 3))), cloud, base, rng
            ),
            "a stone of one point": lambda p: p.plan(
                stone_of(np.array([[5.0, 1.0, 0.4]])), cloud, base, rng
            ),
            "a stone of one point a thousand times": lambda p: p.plan(
                stone_of(np.full((1000, 3), 1.0)), cloud, base, rng
            ),
            "a chassis pose that is not finite": lambda p: p.plan(
                stone, cloud, np.full((4, 4), np.nan), rng
            ),
            "a chassis pose of another shape": lambda p: p.plan(stone, cloud, np.eye(3), rng),
        }
