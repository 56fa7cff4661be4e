"""Sites that are harder to register than the usual one, each in one respect."""

from collections.abc import Callable
from dataclasses import replace
from types import ModuleType
from typing import Any

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3
from executive.messages.cloud import Cloud

Scene = Any  # of tests/plugins/registration/conftest.py
_RAYS = 190_000
_OVERLAP = 0.3  # share of the ground that both clouds show
_LEAST_SHARED = 4  # whole stones on it
_MARGIN_M = 0.6  # from the middle of a whole stone to the cut
_SURVEYED_M = 4.5  # from the site's centre to the farthest stones that the drone surely sees
_MOST_DRAWN = 20  # sites until one can be cut so
_OUTLIERS = 0.1  # share of the points
_TILT, _SLOPE = np.radians(20), np.radians(12)


def usual(scenes: ModuleType, seed: int) -> Scene:
    """Draw seven stones."""
    return scenes.scene_of(seed, rays=_RAYS)


def noisy(scenes: ModuleType, seed: int) -> Scene:
    """Double the noise of both sensors."""
    return scenes.scene_of(seed, rays=_RAYS, noise=2.0)


def littered(scenes: ModuleType, seed: int) -> Scene:
    """Strew points into the air and the ground, a tenth of each cloud."""
    scene, rng = usual(scenes, seed), np.random.default_rng([seed, 1])
    return replace(
        scene,
        target=Cloud("map", _strewn(scene.target.points, rng)),
        source=Cloud("survey", _strewn(scene.source.points, rng)),
    )


def tilted(scenes: ModuleType, seed: int) -> Scene:
    """Tilt the survey by 20 degrees about any horizontal axis."""
    scene, turn = usual(scenes, seed), _about_a_level_axis(_TILT, np.random.default_rng([seed, 2]))
    return replace(
        scene,
        source=Cloud("survey", transform(turn, scene.source.points)),
        T_target_source=scene.T_target_source @ inverse(turn),
    )


def sloping(scenes: ModuleType, seed: int) -> Scene:
    """Incline the site by 12 degrees in the map."""
    scene, turn = usual(scenes, seed), _about_a_level_axis(_SLOPE, np.random.default_rng([seed, 3]))
    return replace(
        scene,
        target=Cloud("map", transform(turn, scene.target.points)),
        T_target_source=turn @ scene.T_target_source,
        centre=transform(turn, scene.centre[None])[0],
        stones=transform(turn, scene.stones),
    )


def overlapping(scenes: ModuleType, seed: int) -> Scene:
    """Draw twelve stones; map and survey are cut so that both show 30 % of the ground, and on it
    four whole stones.
    """
    for number in range(_MOST_DRAWN):
        scene = scenes.scene_of(seed + number * 10**8, count=12, rays=_RAYS)
        cut = _cut(scene, np.random.default_rng([seed, number, 4]))
        if cut is not None:
            break
    else:
        raise ValueError(f"seed {seed}: no site of {_MOST_DRAWN} has four stones in 30 %")
    across, low, high = cut
    places = scene.target.points @ across
    in_map = (
        scene.centre
        + (transform(scene.T_target_source, scene.source.points) - scene.centre) / scene.stretch
    )
    return replace(
        scene,
        target=Cloud("map", scene.target.points[places < high]),
        source=Cloud("survey", scene.source.points[in_map @ across > low]),
    )


def _cut(scene: Scene, rng: np.random.Generator) -> tuple[Float, float, float] | None:
    """Return a direction and two places along it, between which four whole stones stand on 30 % of
    the map's points; None if a hundred tries find none.
    """
    from_centre = np.abs(scene.stones - scene.centre)[:, :2].max(axis=1)
    surveyed = scene.stones[from_centre < _SURVEYED_M]
    few = scene.target.points[::20]
    for _ in range(100):
        heading, begin = rng.uniform(-np.pi, np.pi), rng.uniform(0, 1 - _OVERLAP)
        across = np.array([np.cos(heading), np.sin(heading), 0.0])
        low, high = np.quantile(few @ across, [begin, begin + _OVERLAP])
        stones = surveyed @ across
        if ((stones > low + _MARGIN_M) & (stones < high - _MARGIN_M)).sum() >= _LEAST_SHARED:
            return across, float(low), float(high)
    return None


HARD_SITES: dict[str, Callable[[ModuleType, int], Scene]] = {
    "usual": usual,
    "overlap 30 %": overlapping,
    "noise twice as large": noisy,
    "outliers 10 %": littered,
    "survey tilted 20°": tilted,
    "slope 12°": sloping,
}


def _strewn(points: Float, rng: np.random.Generator) -> Float:
    low, high = points.min(axis=0), points.max(axis=0)
    count = round(len(points) * _OUTLIERS / (1 - _OUTLIERS))
    return np.vstack([points, rng.uniform(low - [0, 0, 0.5], high + [0, 0, 1.0], (count, 3))])


def _about_a_level_axis(angle: float, rng: np.random.Generator) -> Float:
    heading = rng.uniform(-np.pi, np.pi)
    axis = np.array([np.cos(heading), np.sin(heading), 0.0])
    return pose(exp_so3(angle * axis), np.zeros(3))
