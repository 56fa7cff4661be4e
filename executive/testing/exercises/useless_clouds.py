"""Clouds that show nothing: no verb may fall over one of them."""

from collections.abc import Callable
from functools import cache
from typing import TypeVar

import numpy as np

from executive.messages.cloud import Cloud

P = TypeVar("P")


@cache
def useless_clouds(frame: str = "map") -> dict[str, Cloud]:
    """Return clouds that show nothing, by name."""
    line = np.column_stack([np.linspace(0, 5, 500), np.zeros(500), np.zeros(500)])
    wall = np.random.default_rng(0).uniform((0, -3, 0), (0, 3, 3), (2000, 3))
    return {
        "an empty cloud": Cloud(frame, np.empty((0, 3))),
        "one point": Cloud(frame, np.array([[1.0, 2.0, 0.5]])),
        "one point a thousand times": Cloud(frame, np.full((1000, 3), 2.0)),
        "points on a line": Cloud(frame, line),
        "a wall without ground": Cloud(frame, wall),
        "two points a thousand kilometres apart": Cloud(frame, np.array([[0.0] * 3, [1e6] * 3])),
    }


def with_each_cloud(
    call: Callable[[P, Cloud], object], role: str = "", frame: str = "map"
) -> dict[str, Callable[[P], object]]:
    """Return the call with each of these clouds, by the cloud's name and its role in the call."""

    def bound(cloud: Cloud) -> Callable[[P], object]:
        return lambda plugin: call(plugin, cloud)

    return {f"{name} {role}".strip(): bound(c) for name, c in useless_clouds(frame).items()}
