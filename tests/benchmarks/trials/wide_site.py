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
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3
from executive.interfaces.registration import Registrar
from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud
from executive.testing.subject import subject_of
from trials.many_stones import peak_mb
from trials.registration_trial import Trial
from trials.registration_trial import tried as tried_once

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


def registered(seeds: Iterable[int]) -> list[Figure]:
    """Register two clouds of each wide site, each pair in a process of its own."""
    trials, context = list[tuple[Trial, float]](), get_context("spawn")
    for seed in seeds:
        with ProcessPoolExecutor(1, mp_context=context) as process:
            trials.append(process.submit(_registered, seed).result())
    right = sum(one.accepted and one.is_right for one, _ in trials)
    seconds, memory = max(one.cpu_ms / 1e3 for one, _ in trials), max(mb for _, mb in trials)
    words = "two clouds registered, 1000 m across"
    return [
        held(
            f"{words} [%]",
            100 * right / len(trials),
            Bound(99.5, 100.0, is_least=True),
            f"{right} of {len(trials)}",
        ),
        held(f"processor time, {words}, most [s]", seconds, Bound(10)),
        held(f"peak memory, {words}, most [MB]", memory, Bound(1000)),
    ]


def _registered(seed: int) -> tuple[Trial, float]:
    T = pose(exp_so3(np.array([0.0, 0.01, 2.0])), np.array([4.0, -3.0, 1.0]))
    target = drawn(seed, WIDTHS_M[-1])[0]
    source, rng = target.copy(), np.random.default_rng(seed + 500_000)
    for axis in range(3):  # in place, as the most memory is to be that of the registration
        source[:, axis] += rng.normal(0, NOISE_M, POINTS)
    clouds = Cloud("map", target), Cloud("survey", transform(inverse(T), source))
    del target, source
    with subject_of("registration", "segment_shot", ()).started() as plugin:
        assert isinstance(plugin, Registrar)
        return tried_once(plugin, "wide", *clouds, T), peak_mb()


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
