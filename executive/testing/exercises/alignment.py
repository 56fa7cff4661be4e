"""Alignment: a block in a corner seen twice, from a good guess, and clouds that cannot be laid."""

from collections.abc import Callable, Mapping
from functools import cache
from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3
from executive.interfaces.alignment import Aligner
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.testing.digest import locked
from executive.testing.exercise import Exercise
from executive.testing.exercises.useless_clouds import with_each_cloud

T_TRUE = pose(exp_so3(np.array([0.02, -0.03, 0.08])), np.array([0.08, -0.05, 0.04]))


@cache
def corner(seed: int) -> Float:
    """Return three faces of a block on the ground, freshly sampled by each seed [m]."""
    rng = np.random.default_rng(seed)
    u, v = rng.uniform(-0.5, 0.5, (2, 12_000))
    faces = [
        np.column_stack([u, v, np.full(12_000, 0.4)]),
        np.column_stack([np.full(12_000, 0.5), u, 0.8 * v]),
        np.column_stack([u, np.full(12_000, -0.5), 0.8 * v]),
        np.column_stack([3 * u, 3 * v, np.full(12_000, -0.4)]),
    ]
    return np.vstack(faces) + rng.normal(0, 0.006, (48_000, 3))


def clouds() -> tuple[Cloud, Cloud]:
    """Return a target, and a source that `T_TRUE` lays over it."""
    return Cloud("map", corner(1).copy()), Cloud("model", transform(inverse(T_TRUE), corner(2)))


class AlignmentInputs(TypedDict):
    """Two clouds and where the search begins."""

    target: Cloud
    source: Cloud
    T_target_source: Float


class AlignmentExercise(Exercise[Aligner, AlignmentInputs]):
    """One source to its target, from the identity."""

    def inputs(self, machine: Machine) -> AlignmentInputs:
        target, source = clouds()
        return {"target": target, "source": source, "T_target_source": locked(np.eye(4))}

    def run(self, plugin: Aligner, inputs: AlignmentInputs) -> object:
        guess = inputs["T_target_source"]
        return plugin.align(inputs["target"], inputs["source"], guess, 0.3)

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[Aligner], object]]:
        good = Cloud("map", corner(1)[::20].copy())
        start = np.eye(4)
        return {
            **with_each_cloud(lambda p, cloud: p.align(good, cloud, start, 0.3), "as source"),
            **with_each_cloud(lambda p, cloud: p.align(cloud, good, start, 0.3), "as target"),
            "a guess that is not finite": lambda p: p.align(
                good, good, np.full((4, 4), np.nan), 0.3
            ),
            "a guess of another shape": lambda p: p.align(good, good, np.eye(3), 0.3),
            "a reach of zero": lambda p: p.align(good, good, start, 0.0),
        }
