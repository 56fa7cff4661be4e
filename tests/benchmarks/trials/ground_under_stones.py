"""The motion planner's ground against the true one, about the stones of a site's first map."""

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.motion.obstacles import Obstacles
from scipy.ndimage import minimum_filter

from executive.geometry.voxels import voxel_means
from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.load import load_mission

AROUND_M, CELL_M, HALF_M = 1.2, 0.1, 10.0
HIGH_M, LOW_M = 0.05, -0.10
HEADER = "seed stones  > 5 cm high > 10 cm low   simple: high        low"
LEVEL = Bound(0.0005), Bound(0.0005)  # docs/missions.md: 0.0 % on each site
WAVES = Bound(0.024), Bound(0.005)  # the same page, waves of 0.2 m and ruts


def first_map(
    seed: int, overrides: list[str], folder: Path
) -> tuple[np.ndarray, list[np.ndarray], Any]:
    """Return the surroundings as a planner is given them, the estimated places of stones, and the
    terrain.
    """
    known: list[Any] = []

    def look(mission: Any) -> None:
        if not known and mission.account.stones_found:
            mapping, objects, robot = (
                mission.services.plugins[name] for name in ("mapping", "objects", "robot")
            )
            known.extend([mapping.cloud().points, objects.stones(), robot.world.site.terrain])

    Run(load_mission("map_site", overrides), Options(seed=seed, run_dir=folder)).execute(look)
    points, stones, terrain = known
    merged = voxel_means(np.concatenate([points, *(stone.points_map for stone in stones)]), 0.03)
    return merged, [stone.centroid_map[:2] for stone in stones], terrain


def lowest_of_half_a_metre(points: np.ndarray, xy: np.ndarray) -> np.ndarray:
    n = round(2 * HALF_M / CELL_M)
    heights = np.full((n, n), np.inf)
    is_near = (np.abs(points[:, :2]) < HALF_M).all(axis=1)
    np.minimum.at(heights, tuple(_cell(points[is_near, :2]).T), points[is_near, 2])
    return minimum_filter(heights, size=5)[tuple(_cell(xy).T)]


def _cell(xy: np.ndarray) -> np.ndarray:
    return np.floor((xy + HALF_M) / CELL_M).astype(int)


@dataclass(frozen=True, slots=True)
class Shares:
    """Shares of the area about the stones where the ground is estimated wrongly."""

    high: float
    low: float

    @classmethod
    def of(cls, error_m: np.ndarray) -> "Shares":
        return cls(float(np.mean(error_m > HIGH_M)), float(np.mean(error_m < LOW_M)))

    def __str__(self) -> str:
        return f"{self.high:12.1%} {self.low:10.1%}"


@dataclass(frozen=True, slots=True)
class Site:
    """What came of one site: the planner's ground, and the lowest point of half a metre."""

    seed: int
    stones: int
    planner: Shares
    simple: Shares

    def __str__(self) -> str:
        return f"{self.seed:4d} {self.stones:6d} {self.planner}  {self.simple}"


def measured(seed: int, overrides: Sequence[str]) -> Site:
    """Run the mapping mission and compare both grounds with the terrain."""
    with tempfile.TemporaryDirectory() as folder:
        points, stones, terrain = first_map(seed, list(overrides), Path(folder) / "run")
    axis = np.arange(-HALF_M + CELL_M / 2, HALF_M, CELL_M)
    xy = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    xy = xy[np.min([np.linalg.norm(xy - stone, axis=1) for stone in stones], axis=0) < AROUND_M]
    true_m = terrain.height_at(xy)
    simple_m = lowest_of_half_a_metre(points, xy) - true_m
    ours_m = Obstacles(points, HALF_M).depths_in_ground(np.c_[xy, true_m])
    simple = Shares.of(simple_m[np.isfinite(simple_m)])
    return Site(seed, len(stones), Shares.of(ours_m), simple)


def figures(sites: Sequence[Site], has_waves: bool) -> list[Figure]:
    """Hold the worst site against the bounds, and the planner against the simple method."""
    high, low = WAVES if has_waves else LEVEL
    worst = max(site.planner.high for site in sites)
    deepest = max(site.planner.low for site in sites)
    simple = min(site.simple.high for site in sites)
    return [
        held("worst site: share more than 5 cm too high", worst, high, f"{worst:.1%}"),
        held("worst site: share more than 10 cm too low", deepest, low, f"{deepest:.1%}"),
        held(
            "the first, beside the best site of the simple method",
            worst,
            Bound(simple),
            f"{worst:.1%}",
        ),
    ]
