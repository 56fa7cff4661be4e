"""The transform from one cloud to another, and whether it was accepted."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from executive.arrays import Float, checked


@dataclass(frozen=True, slots=True, eq=False)
class Alignment:
    """Result of a local alignment or of a global registration.

    Attributes:
        T_target_source: Pose of the source's frame in the target's, the source scaled by `scale`,
            shape (4, 4).
        accepted: Whether it passed the acceptance tests; do not use a refused transform.
        reason: Why it was refused, or what the tests measured.
        rmse_m: Root mean square distance of inlier correspondences [m].
        overlap: Fraction of source points with a correspondence, 0 … 1.
        matched_segments: Pairs (source segment, target segment) that agree; empty for a local
            alignment.
        scale: Factor on source coordinates: p_target = R (scale · p_source) + t.
        timings_ms: Wall time of each stage, and `total`; for reports only.
    """

    T_target_source: Float
    accepted: bool
    reason: str
    rmse_m: float
    overlap: float
    matched_segments: tuple[tuple[int, int], ...] = ()
    scale: float = 1.0
    timings_ms: Mapping[str, float] = field(default_factory=dict, metadata={"wall_time": True})

    def __post_init__(self) -> None:
        object.__setattr__(
            self, "T_target_source", checked("T_target_source", self.T_target_source, 4, 4)
        )

    def apply(self, points_source: Float) -> Float:
        """Express source points in the target's frame, shape (N, 3)."""
        T = self.T_target_source
        return points_source @ (self.scale * T[:3, :3]).T + T[:3, 3]
