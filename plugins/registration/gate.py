"""Whether a registration is to be believed: how well, how widely and on how many stones the clouds agree.

Centroid votes and inlier counts are no gate: wrong motions were seen to match four to seven stones. Surfaces are.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import small_gicp
from scipy.spatial import cKDTree

from executive.arrays import Float


@dataclass(frozen=True, slots=True)
class Agreement:
    """How a source surface lies on a target surface.

    Attributes:
        rmse_m: Root mean square of distances below the truncation, both ways [m].
        overlap: Share of the source's points with a target point within the truncation.
        coverage: Share of the target's points with a source point within the truncation.
        points: Number of points that were measured, both ways.
    """

    rmse_m: float
    overlap: float
    coverage: float
    points: tuple[int, int]

    @property
    def overlap_of_smaller(self) -> float:
        """The larger of both shares: a stone seen from one side only lies wholly on the whole stone, not vice versa."""
        return max(self.overlap, self.coverage)

    def __str__(self) -> str:
        return f"rmse {self.rmse_m * 100:.1f} cm, overlap {self.overlap:.2f}, coverage {self.coverage:.2f}"


def measure(target: Float, moved: Float, truncation_m: float, voxel_m: float) -> Agreement:
    """Measure both ways between points in one frame, each thinned to an even density."""
    a, b = (small_gicp.voxelgrid_sampling(p, voxel_m, 1).points()[:, :3] for p in (target, moved))
    to_target = cKDTree(a).query(b, distance_upper_bound=truncation_m)[0]
    to_source = cKDTree(b).query(a, distance_upper_bound=truncation_m)[0]
    near = np.concatenate([d[np.isfinite(d)] for d in (to_target, to_source)])
    rmse_m = float(np.sqrt(np.mean(near**2))) if len(near) else truncation_m
    overlap, coverage = (float(np.isfinite(d).mean()) for d in (to_target, to_source))
    return Agreement(rmse_m, overlap, coverage, (len(b), len(a)))


def pooled(agreements: Sequence[Agreement], truncation_m: float) -> Agreement:
    """Return the agreement of several surfaces taken as one."""
    sources, targets = (np.array([a.points[k] for a in agreements], dtype=float) for k in (0, 1))
    near_s = sources * [a.overlap for a in agreements]
    near_t = targets * [a.coverage for a in agreements]
    near = float((near_s + near_t).sum())
    if near == 0.0:
        return Agreement(truncation_m, 0.0, 0.0, (int(sources.sum()), int(targets.sum())))
    squares = float(((near_s + near_t) * [a.rmse_m**2 for a in agreements]).sum())
    shares = float(near_s.sum() / sources.sum()), float(near_t.sum() / targets.sum())
    return Agreement(float(np.sqrt(squares / near)), *shares, (int(sources.sum()), int(targets.sum())))
