"""Registration: a site of five boulders and its survey, another site, and clouds of nothing."""

from collections.abc import Callable, Mapping
from functools import cache
from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import from_rpy
from executive.interfaces.registration import Registrar
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.testing.exercise import Exercise
from executive.testing.exercises.useless_clouds import with_each_cloud

T_TRUE = pose(from_rpy(0.03, -0.04, 2.2), np.array([14.0, -8.0, 3.0]))


@cache
def site(stones_seed: int, sampling_seed: int) -> Float:
    """Return five lumpy boulders on level ground [m]; one stones' seed is one site, sampled
    differently by each sampling seed.
    """
    shape, rng = np.random.default_rng(stones_seed), np.random.default_rng(sampling_seed)
    xy = rng.uniform(-5.5, 5.5, (60_000, 2))
    parts = [np.column_stack([xy, 0.04 * np.sin(xy[:, 0] + stones_seed)])]
    angles = np.arange(5) * 1.2566 + shape.uniform(-0.3, 0.3, 5)
    for angle in angles:
        distance, size = shape.uniform(1.8, 4.2), shape.uniform(0.5, 0.7)
        squeeze, turn = shape.uniform(0.6, 1.0, 3), from_rpy(*shape.uniform(-3, 3, 3))
        waves = shape.normal(0, 2, (3, 3))
        d = rng.normal(size=(9000, 3))
        d /= np.linalg.norm(d, axis=1)[:, None]
        lump = d * (size * (1 + 0.12 * np.sin(d @ waves).sum(axis=1)))[:, None] * squeeze @ turn.T
        lump += [distance * np.cos(angle), distance * np.sin(angle), 0.25]
        parts.append(lump[lump[:, 2] > 0])
    points = np.vstack(parts)
    return points + rng.normal(0, 0.008, points.shape)


def mapped(stones_seed: int) -> Cloud:
    """Return a site as the machine maps it."""
    return Cloud("map", site(stones_seed, 5).copy())


def survey(stones_seed: int, scale: float = 1.006) -> Cloud:
    """Return a site as a drone surveys it: in its own frame, its scale off by 0.6 %."""
    return Cloud("survey", transform(inverse(T_TRUE), site(stones_seed, 77) * scale))


class RegistrationInputs(TypedDict):
    """A map and a survey of one site."""

    target: Cloud
    source: Cloud


class RegistrationExercise(Exercise[Registrar, RegistrationInputs]):
    """One survey to its map."""

    def inputs(self, machine: Machine) -> RegistrationInputs:
        return {"target": mapped(1), "source": survey(1)}

    def run(self, plugin: Registrar, inputs: RegistrationInputs) -> object:
        return plugin.register(inputs["target"], inputs["source"], np.random.default_rng(3))

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[Registrar], object]]:
        good = Cloud("map", site(1, 5)[::20].copy())
        rng = np.random.default_rng(0)
        return {
            **with_each_cloud(lambda p, c: p.register(good, c, rng), "as survey", "survey"),
            **with_each_cloud(lambda p, c: p.register(c, good, rng), "as map"),
            **with_each_cloud(lambda p, c: p.find(c, good), "to find an object in"),
            **with_each_cloud(lambda p, c: p.find(good, c), "as object"),
        }
