"""Segmentation: level ground with three boulders, and clouds without either."""

from collections.abc import Callable, Mapping
from functools import cache
from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.interfaces.segmentation import Segmenter
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.testing.exercise import Exercise
from executive.testing.exercises.useless_clouds import with_each_cloud

SPOTS = np.array([[3.0, 0.0], [0.0, 4.0], [-3.5, -2.0]])


@cache
def _site() -> Float:
    rng = np.random.default_rng(0)
    xy = rng.uniform(-7, 7, (30_000, 2))
    parts = [np.column_stack([xy, np.zeros(len(xy))])]
    for k, spot in enumerate(SPOTS):
        d = rng.normal(size=(4000, 3))
        d /= np.linalg.norm(d, axis=1)[:, None]
        boulder = d * (0.5 + 0.1 * k) * [1, 0.8, 0.9] + [*spot, 0.2]
        parts.append(boulder[boulder[:, 2] > 0])
    points = np.vstack(parts)
    return points + rng.normal(0, 0.01, points.shape)


def site(shift: Float | float = 0.0) -> Float:
    """Return level ground and three half-buried boulders of different sizes, 1 cm of noise [m]."""
    return _site() + shift


class SegmentationInputs(TypedDict):
    """A site, and a survey of it."""

    cloud: Cloud
    survey: Cloud


class SegmentationExercise(Exercise[Segmenter, SegmentationInputs]):
    """One cloud to its segments, and two clouds to one."""

    def inputs(self, machine: Machine) -> SegmentationInputs:
        return {"cloud": Cloud("map", site()), "survey": Cloud("map", site(0.02)[::3])}

    def run(self, plugin: Segmenter, inputs: SegmentationInputs) -> object:
        merged = plugin.merge([inputs["cloud"], inputs["survey"]])
        return plugin.segment(inputs["cloud"]), merged

    def hostile(self, machine: Machine) -> Mapping[str, Callable[[Segmenter], object]]:
        return {
            **with_each_cloud(lambda plugin, cloud: plugin.segment(cloud)),
            **with_each_cloud(lambda plugin, cloud: plugin.merge([cloud]), "to merge"),
            "nothing to merge": lambda plugin: plugin.merge([]),
        }
