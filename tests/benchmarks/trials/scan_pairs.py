"""What `scan_pairs.py` measures."""

from collections.abc import Iterable

import numpy as np
from bounds import Bound, Figure, held

from trials.mapping import recorded
from trials.mapping_trials import TrueState, as_it_is, trial

PAIR_MS = Bound(30.0, 20.0)


def measured(seeds: Iterable[int]) -> list[Figure]:
    """Return how long scan pairs take [ms]."""
    spent_ms = list[float]()
    for seed in seeds:
        ticks, track = recorded(seed)
        truth = TrueState()
        one = trial("truth", truth, ["voxel_map"], as_it_is)
        for tick, at in zip(ticks, track, strict=True):
            truth.track = [*truth.track[-60:], at]
            one.process(tick)
        spent_ms += one.fan.pair_ms["voxel_map"]
        one.fan.mappers["voxel_map"].close()
    late_ms = float(np.percentile(spent_ms, 95))
    words = f"{late_ms:.1f} (median {np.median(spent_ms):.1f}, n {len(spent_ms)})"
    return [held("scan pair, p95 [ms]", late_ms, PAIR_MS, words)]
