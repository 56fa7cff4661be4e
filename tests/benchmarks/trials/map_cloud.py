"""What `map_cloud.py` measures."""

import time
from collections import defaultdict
from collections.abc import Callable, Iterable

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.mapping.cylinder import Cylinder
from executive_plugins.mapping.map_cloud import MapCloud
from executive_plugins.mapping.settings import VoxelMapSettings
from executive_plugins.mapping.voxel_grid import VoxelGrid

from executive.arrays import Float

RADIUS_M, RETURNS, RINGS, NOISE_M = 10.0, 10_000, 32, 0.012
PAIRS, TOGETHER = 20, 5  # of which the cloud is read after each, then after so many
CLOUD_MS = Bound(30.0)


class Ground:
    """Waves and half-buried balls, sampled anywhere."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._phase = rng.uniform(0, 2 * np.pi, 2)
        self._middles = rng.uniform(-8, 8, (30, 2))
        self._radii_m = rng.uniform(0.2, 0.7, 30)

    def at(self, places: Float) -> Float:
        """Return noisy returns from places (N, 2) on the ground [m], shape (N, 3)."""
        heights = (
            0.2
            * np.sin(places[:, 0] + self._phase[0])
            * np.cos(0.7 * places[:, 1] + self._phase[1])
        )
        for middle, radius_m in zip(self._middles, self._radii_m, strict=True):
            square = radius_m**2 - ((places - middle) ** 2).sum(axis=1)
            heights += np.sqrt(np.maximum(square, 0.0))
        points = np.column_stack([places, heights])
        return np.asarray(points + self._rng.normal(0, NOISE_M, points.shape))

    def anywhere(self, count: int) -> Float:
        """Return so many places within the map's radius, shape (N, 2)."""
        away_m = RADIUS_M * np.sqrt(self._rng.uniform(0, 1, count))
        turn = self._rng.uniform(0, 2 * np.pi, count)
        return np.column_stack([away_m * np.cos(turn), away_m * np.sin(turn)])

    def rings(self, heading_rad: float) -> Float:
        """Return the places of a pair: of each ring two thirds of a circle, shape (N, 2)."""
        away_m = np.repeat(np.geomspace(2.5, 9.8, RINGS), RETURNS // RINGS)
        turn = heading_rad + np.tile(np.linspace(-2.1, 2.1, RETURNS // RINGS), RINGS)
        return np.column_stack([away_m * np.cos(turn), away_m * np.sin(turn)])


def _cpu_ms(action: Callable[[], object]) -> float:
    begun_s = time.process_time()
    action()
    return 1e3 * (time.process_time() - begun_s)


def measured(seeds: Iterable[int]) -> list[Figure]:
    """Return medians over all readings of all seeds."""
    settings, cylinder = VoxelMapSettings(), Cylinder(RADIUS_M)
    VoxelGrid.compile()
    MapCloud.compile(settings)
    ms, voxels = defaultdict[str, list[float]](list), list[int]()
    for seed in seeds:
        rng = np.random.default_rng(seed)
        ground, grid, surface = Ground(rng), VoxelGrid(settings.voxel_m, 100), MapCloud(settings)
        while len(grid) < 380_000:
            grid.insert(ground.at(ground.anywhere(200_000)))
        ms["anew"].append(_cpu_ms(lambda: surface.cloud(grid, cylinder)))  # noqa: B023
        for pair in range(2 * PAIRS):
            grid.insert(ground.at(ground.rings(0.1 * pair)))
            if pair < PAIRS:
                ms["pair"].append(_cpu_ms(lambda: surface.cloud(grid, cylinder)))  # noqa: B023
            elif pair % TOGETHER == TOGETHER - 1:
                ms["density"].append(
                    _cpu_ms(lambda: surface.counts(surface.current(grid), np.zeros(2), 9))  # noqa: B023
                )
                ms["five"].append(_cpu_ms(lambda: surface.cloud(grid, cylinder)))  # noqa: B023
        voxels.append(len(grid))
    size = f"{min(voxels):,} to {max(voxels):,} voxels"
    return [
        held(f"`cloud()` after a scan pair, {size} [ms]", *_told(ms["pair"], CLOUD_MS)),
        held(f"`cloud()` after {TOGETHER} pairs and a density [ms]", *_told(ms["five"], CLOUD_MS)),
        held(f"density after {TOGETHER} pairs [ms]", *_told(ms["density"], CLOUD_MS)),
        held("`cloud()` of a map that is new [ms]", *_told(ms["anew"], CLOUD_MS)),
    ]


def _told(values: list[float], bound: Bound) -> tuple[float, Bound, str]:
    words = f"{np.median(values):.1f} (p95 {np.percentile(values, 95):.1f}, n {len(values)})"
    return float(np.median(values)), bound, words
