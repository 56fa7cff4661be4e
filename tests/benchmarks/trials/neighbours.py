"""How many stones are one segment each, by the gap to their neighbour.

Seeds 7500 and up are drawn here only; nothing has been tuned on them.
"""

import time
from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings
from perception.piles import load_scenes, piles_of
from scipy.spatial import cKDTree

from executive.arrays import Float, Int
from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud

STONES, SCENES, FIRST_SEED = 7, 10, 7500
BANDS_M = ((0.05, 0.10), (0.10, 0.15), (0.15, 0.30))
CLOSE_M = ((0.0, 0.002), (0.01, 0.02))  # touching, and a finger's width apart
NAMES = {0.0: "touching", 0.01: "1 to 2 cm apart", 0.05: "gaps of 5 cm up"}
Tallies = dict[tuple[str, tuple[float, float]], Counter[str]]
BOUNDS = {
    0.05: Bound(0.99, 0.995, is_least=True),
    0.01: Bound(0.90, 0.95, is_least=True),
    0.0: Bound(0.85, 0.92, is_least=True),
}
FALSE = Bound(0.005)
FATES = ("single", "merged", "split", "missed")
OTHERS = 0.2  # share of a segment's points that are of another thing
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


def tallied(
    make_piles: Callable,
    scenes: int,
    bands_m: Sequence[tuple[float, float]] = BANDS_M,
    first: int = FIRST_SEED,
) -> tuple[Tallies, dict[str, list[float]]]:
    """Segment so many scenes a gap and kind of stones; return the fates of stones and the segments
    that hold two, and what a cloud took [ms].
    """
    segmentation = GroundAndClusters(GroundAndClustersSettings(), load_machine("m545"))
    segmentation.start()
    spent_ms: dict[str, list[float]] = {"lidar": [], "drone": []}
    tallies = {(shape, band): Counter[str]() for shape in ("convex", "scanned") for band in bands_m}
    for (shape, band), tally in tallies.items():
        for seed in range(first, first + scenes):
            for kind, (points, labels) in make_piles(seed, band, shape).clouds.items():
                begun_s = time.process_time()
                found = [one.points for one in segmentation.segment(Cloud(kind, points)).segments]
                spent_ms[kind].append(1e3 * (time.process_time() - begun_s))
                tally.update(fates(points, labels, found))
                tally["segments"] += len(found)
                tally["false"] += false_of(points, labels, found)
    return tallies, spent_ms


def false_of(points: Float, labels: Int, segments: list[Float]) -> int:
    """Return how many segments are no stone: a fifth or more of another one, or of the ground."""
    tree, found = cKDTree(points), 0
    for one in segments:
        shares = np.sort(np.bincount(labels[tree.query(one)[1]], minlength=STONES + 1) / len(one))
        found += int(shares[-2] > OTHERS)
    return found


def summed(tallies: Tallies, least_m: float) -> Counter[str]:
    """Return the fates of all stones whose gap is at least so wide."""
    return sum((tally for (_, band), tally in tallies.items() if band[0] >= least_m), Counter())


def seen(tally: Counter[str]) -> int:
    """Return how many stones were there to be seen."""
    return sum(tally[fate] for fate in FATES)


def _print(shape: str, gap: str, tally: Counter[str]) -> None:
    counts = "".join(f"{tally[fate]:8d}" for fate in ("merged", "split", "missed"))
    print(f"  {shape:10}{gap:>10}{tally['single'] / seen(tally):10.1%}{counts}{seen(tally):6d}")


def measured(scenes: int, first: int = FIRST_SEED) -> list[Figure]:
    """Segment piles of stones, print what became of each, and hold the shares against bounds."""
    module = load_scenes()
    tallies, spent_ms = tallied(
        lambda seed, gap, shape: piles_of(seed, gap, shape, module),
        scenes,
        (*CLOSE_M, *BANDS_M),
        first,
    )
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
    for least_m, bound in BOUNDS.items():
        tally = summed({key: one for key, one in tallies.items() if key[1] in _bands(least_m)}, 0.0)
        words = f"{tally['single']} of {seen(tally)}"
        name = f"stones that are one segment, {NAMES[least_m]}"
        found.append(held(name, tally["single"] / seen(tally), bound, words))
    every = summed(tallies, 0.0)
    words = f"{every['false']} of {every['segments']}"
    share = every["false"] / max(every["segments"], 1)
    return [*found, held("segments of two things", share, FALSE, words)]


def _bands(least_m: float) -> tuple[tuple[float, float], ...]:
    """Return the bands of gaps that a bound is about."""
    return BANDS_M if least_m == BANDS_M[0][0] else tuple(b for b in CLOSE_M if b[0] == least_m)
