"""Lay the motion planner's ground over the true one, about stones, in the first map of a site.

    OMP_NUM_THREADS=1 python tests/benchmarks/ground_under_stones.py 1 2 3
    OMP_NUM_THREADS=1 python tests/benchmarks/ground_under_stones.py 1 2 3 --
    robot.site.terrain.undulation_m=0.2

One line a seed: of the area within 1.2 m of a stone, how much is believed more than 5 cm too high,
where ways are refused that are free, and more than 10 cm too low, where jaws would dig; and the
same for the lowest point of half a metre, which is the nearest simple method. What follows `--` are
settings, as of `executive run --set`.
"""

import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from executive_plugins.motion.obstacles import Obstacles
from scipy.ndimage import minimum_filter

from executive.geometry.voxels import voxel_means
from executive.mission.run import Options, Run
from executive.tree.load import load_mission

AROUND_M, CELL_M, HALF_M = 1.2, 0.1, 10.0
HIGH_M, LOW_M = 0.05, -0.10


def first_map(
    seed: int, overrides: list[str], folder: Path
) -> tuple[np.ndarray, list[np.ndarray], Any]:
    """Return the surroundings as a planner is given them, where stones are believed, and the
    terrain.
    """
    known: list[Any] = []

    def look(mission: Any) -> None:
        if not known and any(entry.kind == "segmented" for entry in mission.services.entries):
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


def shares(error_m: np.ndarray) -> str:
    return f"{np.mean(error_m > HIGH_M):12.1%} {np.mean(error_m < LOW_M):10.1%}"


def line(seed: int, overrides: list[str]) -> str:
    with tempfile.TemporaryDirectory() as folder:
        points, stones, terrain = first_map(seed, overrides, Path(folder) / "run")
    axis = np.arange(-HALF_M + CELL_M / 2, HALF_M, CELL_M)
    xy = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    xy = xy[np.min([np.linalg.norm(xy - stone, axis=1) for stone in stones], axis=0) < AROUND_M]
    true_m = terrain.height_at(xy)
    simple_m = lowest_of_half_a_metre(points, xy) - true_m
    ours_m = Obstacles(points, HALF_M).depths_in_ground(np.c_[xy, true_m])
    return f"{seed:4d} {len(stones):6d} {shares(ours_m)}  {shares(simple_m[np.isfinite(simple_m)])}"


def main(seeds: list[int], overrides: list[str]) -> None:
    print("seed stones  > 5 cm high > 10 cm low   simple: high        low", flush=True)
    for seed in seeds:
        print(line(seed, overrides), flush=True)


if __name__ == "__main__":
    words = sys.argv[1:]
    cut = words.index("--") if "--" in words else len(words)
    main([int(word) for word in words[:cut]] or [1], words[cut + 1 :])
