"""The transform from one cloud to another, and whether it was accepted."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from executive.arrays import Float, checked


@dataclass(frozen=True, slots=True, eq=False)
class Rival:
    """The second-best motion of a registration, which lays the stones elsewhere.

    Attributes:
        T_target_source: As in `Alignment`, shape (4, 4).
        scale: As in `Alignment`.
        likelihood_ratio: How likely the clouds are under this motion, in their likelihood under the
            best one.
        matched_segments: Pairs (source segment, target segment) that agree under this motion.
    """

    T_target_source: Float
    scale: float
    likelihood_ratio: float
    matched_segments: tuple[tuple[int, int], ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(
            self, "T_target_source", checked("T_target_source", self.T_target_source, 4, 4)
        )


@dataclass(frozen=True, slots=True, eq=False)
class Uncertainty:
    """The error that a motion may have.

    Attributes:
        covariance: Of a small rotation [rad] and a shift [m] of the moved source, along the axes of
            the target's frame, shape (6, 6).
        centre: The point of the target's frame about which the rotation turns [m], shape (3,).
    """

    covariance: Float
    centre: Float

    def __post_init__(self) -> None:
        object.__setattr__(self, "covariance", checked("covariance", self.covariance, 6, 6))
        object.__setattr__(self, "centre", checked("centre", self.centre, 3))


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
        rival: The best motion that lays the stones elsewhere, of those that were tried; None if
            there is none, or if it was not looked for.
        uncertainty: The error that an accepted motion may have; None if it is not known.
        is_final: Whether the same source must be refused again, because it has too little to be
            registered by: nothing should retry it.
    """

    T_target_source: Float
    accepted: bool
    reason: str
    rmse_m: float
    overlap: float
    matched_segments: tuple[tuple[int, int], ...] = ()
    scale: float = 1.0
    timings_ms: Mapping[str, float] = field(default_factory=dict, metadata={"wall_time": True})
    rival: Rival | None = None
    uncertainty: Uncertainty | None = None
    is_final: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(
            self, "T_target_source", checked("T_target_source", self.T_target_source, 4, 4)
        )

    def apply(self, points_source: Float) -> Float:
        """Express source points in the target's frame, shape (N, 3)."""
        T = self.T_target_source
        return points_source @ (self.scale * T[:3, :3]).T + T[:3, 3]
