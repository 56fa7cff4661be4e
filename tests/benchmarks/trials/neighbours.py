"""How many stones are one segment each, by the gap to their neighbour.

Seeds 7500 and up are drawn here only; nothing has been tuned on them.
"""

import time
from collections import Counter
from collections.abc import Callable

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings
from perception.piles import load_scenes, piles_of
from scipy.spatial import cKDTree

from executive.arrays import Float, Int
from executive.messages.cloud import Cloud

STONES, SCENES, FIRST_SEED = 7, 10, 7500
BANDS_M = ((0.05, 0.10), (0.10, 0.15), (0.15, 0.30))
Tallies = dict[tuple[str, tuple[float, float]], Counter[str]]
NARROW, WIDE = Bound(0.90, 0.97, is_least=True), Bound(0.97, 0.99, is_least=True)
LEAST_SEEN = 100  # points: fewer of a stone are not asked for


def fates(points: Float, labels: Int, segments: list[Float]) -> list[str]:
    """Return what became of each stone: single, merged, split, missed or unseen."""
    tree = cKDTree(points)
    counts = np.array(
        [np.bincount(labels[tree.query(one)[1]], minlength=STONES + 1) for one in segments],
        dtype=float,
    )
    counts = counts.reshape(-1, STONES + 1)
    shares = counts / np.maximum(counts.sum(axis=0), 1)
    return [
        _fate(shares, counts[:, stone].sum(), (labels == stone).sum(), stone)
        for stone in range(1, STONES + 1)
    ]


def _fate(shares: Float, kept: float, seen: int, stone: int) -> str:
    if seen < LEAST_SEEN:
        return "unseen"
    if kept < 0.3 * seen:
        return "missed"
    if (shares[:, stone] > 0.15).sum() > 1 or shares[:, stone].max() < 0.5:
        return "split"
    others = np.delete(shares[shares[:, stone].argmax(), 1:], stone - 1)
    return "merged" if others.max() > 0.2 else "single"


def tallied(make_piles: Callable, scenes: int) -> tuple[Tallies, dict[str, list[float]]]:
    """Segment so many scenes a gap and kind of stones; return the fates of stones, and what a cloud
    took [ms].
    """
    segmentation = GroundAndClusters(GroundAndClustersSettings())
    segmentation.start()
    spent_ms: dict[str, list[float]] = {"lidar": [], "drone": []}
    tallies = {(shape, band): Counter[str]() for shape in ("convex", "scanned") for band in BANDS_M}
    for (shape, band), tally in tallies.items():
        for seed in range(FIRST_SEED, FIRST_SEED + scenes):
            for kind, (points, labels) in make_piles(seed, band, shape).clouds.items():
                begun_s = time.process_time()
                found = segmentation.segment(Cloud(kind, points)).segments
                spent_ms[kind].append(1e3 * (time.process_time() - begun_s))
                tally.update(fates(points, labels, [one.points for one in found]))
    return tallies, spent_ms


def summed(tallies: Tallies, least_m: float) -> Counter[str]:
    """Return the fates of all stones whose gap is at least so wide."""
    return sum((tally for (_, band), tally in tallies.items() if band[0] >= least_m), Counter())


def seen(tally: Counter[str]) -> int:
    """Return how many stones were there to be seen."""
    return tally.total() - tally["unseen"]


def _print(shape: str, gap: str, tally: Counter[str]) -> None:
    counts = "".join(f"{tally[fate]:8d}" for fate in ("merged", "split", "missed"))
    print(f"  {shape:10}{gap:>10}{tally['single'] / seen(tally):10.1%}{counts}{seen(tally):6d}")


def measured(scenes: int) -> list[Figure]:
    """Segment piles of stones, print what became of each, and hold the shares against bounds."""
    module = load_scenes()
    tallies, spent_ms = tallied(lambda seed, gap, shape: piles_of(seed, gap, shape, module), scenes)
    print(
        f"  {'stones':10}{'gap [cm]':>10}{'single':>10}{'merged':>8}{'split':>8}{'missed':>8}"
        f"{'seen':>6}"
    )
    for (shape, band), tally in tallies.items():
        _print(shape, f"{100 * band[0]:.0f}-{100 * band[1]:.0f}", tally)
    for kind, spent in spent_ms.items():
        print(
            f"  {kind}: {np.median(spent):.0f} ms median, "
            f"{np.percentile(spent, 95):.0f} ms p95, n {len(spent)}"
        )
    found = []
    for least_m, bound in ((0.0, NARROW), (0.15, WIDE)):
        tally = summed(tallies, least_m)
        words = f"{tally['single']} of {seen(tally)}"
        name = f"stones that are one segment, gaps of {100 * max(least_m, BANDS_M[0][0]):.0f} cm up"
        found.append(held(name, tally["single"] / seen(tally), bound, words))
    return found
