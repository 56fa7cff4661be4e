"""What `wide_site.py` measures."""

import time
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings

from executive.arrays import Float, Int
from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud
from trials.many_stones import peak_mb

POINTS, STONES, POINTS_OF_STONE = 5_000_000, 400, 1250
WIDTHS_M = (200.0, 1000.0)
WAVE_M, WAVE_LENGTH_M, NOISE_M = 0.3, 21.0, 0.01
MARGIN_M = GroundAndClustersSettings().plane_margin_m
NEAR_M = 0.25  # from a stone's middle to that of its segment
_ROW = 20  # stones along each side


@dataclass(frozen=True, slots=True)
class WideTrial:
    """One segmentation.

    Attributes:
        width_m: Side of the site.
        found: Stones at whose place one segment is, with half to twice the points that rise.
        false: Segments that are no stone.
        lost: Points of the ground that are no ground.
        cpu_s: Processor time of the segmentation.
        peak_mb: Most memory of the process that drew and segmented.
    """

    width_m: float
    found: int
    false: int
    lost: int
    cpu_s: float
    peak_mb: float


def measured(seeds: Iterable[int]) -> list[WideTrial]:
    """Segment the sites of all seeds, each in a process of its own."""
    trials, context = list[WideTrial](), get_context("spawn")
    for seed in seeds:
        for width_m in WIDTHS_M:
            with ProcessPoolExecutor(1, mp_context=context) as process:
                trials.append(process.submit(tried, seed, width_m).result())
    return trials


def tried(seed: int, width_m: float) -> WideTrial:
    """Draw and segment a site."""
    plugin = GroundAndClusters(GroundAndClustersSettings(), load_machine("m545"))
    plugin.start()
    points, middles, sizes = drawn(seed, width_m)
    cloud = Cloud("map", points)
    begun_s = time.thread_time()
    seen = plugin.segment(cloud)
    cpu_s, memory_mb = time.thread_time() - begun_s, peak_mb()
    found = 0
    for middle, size in zip(middles, sizes, strict=True):
        near = [s for s in seen.segments if np.linalg.norm(s.centroid - middle) < NEAR_M]
        found += len(near) == 1 and size / 2 <= len(near[0].points) <= 2 * size
    ground = POINTS - STONES * POINTS_OF_STONE
    lost = max(ground - len(seen.ground), 0)
    return WideTrial(width_m, found, len(seen.segments) - found, lost, cpu_s, memory_mb)


def drawn(seed: int, width_m: float) -> tuple[Float, Float, Int]:
    """Return the points of a site [m], shape (N, 3), and of its stones the middles [m] and the
    numbers of points that rise above the ground's margin.

    They are written in place: the most memory is to be that of the segmentation.
    """
    rng, points = np.random.default_rng(seed), np.empty((POINTS, 3))
    ground = points[: POINTS - STONES * POINTS_OF_STONE]
    for axis in range(2):
        ground[:, axis] = rng.uniform(0, width_m, len(ground))
    ground[:, 2] = _waves(ground[:, 0])
    pitch_m, middles, sizes = width_m / _ROW, np.empty((STONES, 3)), np.empty(STONES, dtype=int)
    for k in range(STONES):
        place = (np.array([k % _ROW, k // _ROW]) + rng.uniform(0.3, 0.7, 2)) * pitch_m
        sides = rng.uniform(0.3, 0.6) * np.array([1.0, *rng.uniform(0.6, 1.0, 2)])
        d = rng.normal(size=(POINTS_OF_STONE, 3))
        d /= np.linalg.norm(d, axis=1)[:, None]
        d[:, 2] = np.abs(d[:, 2])  # what is seen from above
        first = len(ground) + k * POINTS_OF_STONE
        stone = points[first : first + POINTS_OF_STONE]
        stone[:] = d * sides + [*place, _waves(place[:1])[0]]
        rises = d[:, 2] * sides[2] > MARGIN_M
        middles[k], sizes[k] = stone[rises].mean(axis=0), rises.sum()
    for axis in range(3):
        points[:, axis] += rng.normal(0, NOISE_M, POINTS)
    return points, middles, sizes


def _waves(x: Float) -> Float:
    return np.asarray(WAVE_M * np.sin(2 * np.pi / WAVE_LENGTH_M * x))


def figures(trials: Sequence[WideTrial]) -> list[Figure]:
    """Return the figures with their bounds, of each width."""
    told = []
    for width_m in WIDTHS_M:
        these = [one for one in trials if one.width_m == width_m]
        found, asked = sum(one.found for one in these), STONES * len(these)
        false, words = sum(one.false for one in these), f"{width_m:.0f} m across"
        seen = Bound(99.0, 100.0, is_least=True)
        told += [
            held(f"stones, {words} [%]", 100 * found / asked, seen, f"{found} of {asked}"),
            held(
                f"segments that are no stone, {words} [%]",
                100 * false / max(found + false, 1),
                Bound(0.5),
                f"{false} of {found + false}",
            ),
            Figure(f"points of the ground that are none, {words}",
                   f"{max(one.lost for one in these):,} of "
                   f"{POINTS - STONES * POINTS_OF_STONE:,}"),
            held(f"processor time, {words}, most [s]", max(t.cpu_s for t in these), Bound(10)),
            held(f"peak memory, {words}, most [MB]", max(t.peak_mb for t in these), Bound(1000)),
        ]  # fmt: skip
    return told
