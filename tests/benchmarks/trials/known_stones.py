"""How well the model of a surveyed stone is its true hull."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from bounds import Bound, Figure, held
from scipy.spatial import ConvexHull

from executive.arrays import Float
from trials.seen_stones import as_surveyed

_VOLUME = Bound(0.05)  # what `leaf/weighing.py` takes a hull's volume to be off by, two deviations
_DIRECTIONS = 800
_LEVEL, _STEEP = 0.4, 0.85  # sines of directions: sides are less, the underside is between both


def measured(folders: Sequence[Path]) -> list[Figure]:
    """Return the figures over the stones of runs of `survey_alone.yaml`."""
    rng = np.random.default_rng(1)
    U = rng.normal(size=(_DIRECTIONS, 3))
    U /= np.linalg.norm(U, axis=1)[:, None]
    sides = np.abs(U[:, 2]) < _LEVEL
    below = (U[:, 2] < -_LEVEL) & (U[:, 2] > -_STEEP)
    ratios, off_m = [], []
    for seen in as_surveyed(folders):
        known, true = seen.stone.points_map, seen.hull
        ratios.append(ConvexHull(known).volume / ConvexHull(true).volume)
        support_m = (known @ U.T).max(axis=0) - (true @ U.T).max(axis=0)
        off_m.append([support_m[part].mean() for part in (sides, below)])
    return [
        Figure("stones", str(len(ratios))),
        Figure("volume over the true one", f"{np.mean(ratios):.3f} ± {np.std(ratios):.3f}"),
        Figure("sides farther out than the true ones [cm]", _spread(off_m, 0)),
        Figure("underside [cm]", _spread(off_m, 1)),
        held(
            "error of the volume, 95 %", float(np.quantile(np.abs(np.log(ratios)), 0.95)), _VOLUME
        ),
    ]


def _spread(off_m: list[list[float]], column: int) -> str:
    values: Float = 100 * np.array(off_m)[:, column]
    return f"{values.mean():.1f} ± {values.std():.1f}"
