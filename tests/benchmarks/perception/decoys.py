"""Surveys that are not of the site, each similar to it in another respect."""

from collections.abc import Callable
from types import ModuleType

import numpy as np
from scipy.spatial import ConvexHull

from executive.messages.cloud import Cloud

Pair = tuple[Cloud, Cloud]


def another_site(scenes: ModuleType, seed: int, rays: int) -> Pair:
    """Draw a survey of seven stones elsewhere."""
    scene = scenes.scene_of(seed, rays=rays, survey_seed=seed + 50_000)
    return scene.target, scene.source


def mirrored(scenes: ModuleType, seed: int, rays: int) -> Pair:
    """Mirror the survey: distances and sizes stay the same, but no rigid motion fits."""
    scene = scenes.scene_of(seed, rays=rays)
    return scene.target, Cloud("survey", scene.source.points * [1.0, -1.0, 1.0])


def other_stones(scenes: ModuleType, seed: int, rays: int) -> Pair:
    """Put other stones into the same places: their constellation fits, their surfaces do not."""
    scene = scenes.scene_of(seed, rays=rays)
    rng = np.random.default_rng(seed + 60_000)
    site, _ = scenes._world(rng, 0, 0.0, 1.0, scenes._stone)
    for x, y, _ in scene.stones:
        corners = scenes._stone(rng)
        corners += [x, y, -corners[:, 2].min() - 0.05]
        scenes._add(site, corners, ConvexHull(corners).simplices)
    return scene.target, Cloud("survey", scenes._surveyed(site, rng, rays, scene.centre))


DECOYS: dict[str, Callable[[ModuleType, int, int], Pair]] = {
    "another site": another_site,
    "mirrored": mirrored,
    "other stones in the same places": other_stones,
}
