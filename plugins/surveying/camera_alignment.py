"""Scale, heading and level of a reconstruction, from the drone's recorded positions."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Bool, Float
from executive.errors import DataError
from executive.geometry.rigid_fit import similarity_fit

_TRIALS = 100  # random triples; with a third of outliers, one in four has none
_SIGMAS = 2.5  # a position farther off than this is an outlier
_LEAST_WIDTH = 0.1  # spread across the line of flight, as a share of that along it


@dataclass(frozen=True, slots=True, eq=False)
class CameraAlignment:
    """p_survey = scale · R p_model + t.

    Attributes:
        scale: Of the survey to the model.
        R: Rotation, shape (3, 3).
        t: Translation [m], shape (3,).
        is_used: Which positions agree, shape (N,).
        residual_m: Root mean square distance of those from the cameras [m].
        scale_error: Standard deviation of the scale that follows from it, as a share.
    """

    scale: float
    R: Float
    t: Float
    is_used: Bool
    residual_m: float
    scale_error: float

    def apply(self, points_model: Float) -> Float:
        """Express points (N, 3) of the model in the survey's frame [m]."""
        return np.asarray(self.scale * points_model @ self.R.T + self.t)


def align_cameras(
    centres_model: Float, positions_m: Float, rng: np.random.Generator
) -> CameraAlignment:
    """Find the similarity from cameras to rough positions (Mascaro 2020, Sec. 4.1), some of which
    may be far off.

    The least median of squares over random triples tells which positions agree (Rousseeuw 1984: no
    threshold, up to half may be wrong); a least-squares fit on those follows. The paper takes
    positions of visual-inertial odometry, which are good to centimetres; a satellite receiver's are
    good to a metre, so the scale's error is stated.

    Args:
        centres_model: Cameras in the reconstruction's own frame and scale, shape (N, 3).
        positions_m: Where they were, roughly [m], shape (N, 3).
        rng: Chance.

    Raises:
        DataError: If the cameras are fewer than four, or lie in a line: then the roll about it is
            anyone's guess.
    """
    count = len(centres_model)
    _check_spread(centres_model)
    best = np.full(count, np.inf)
    for _ in range(_TRIALS):
        triple = rng.choice(count, 3, replace=False)
        squares = _squares(
            similarity_fit(positions_m[triple], centres_model[triple]), centres_model, positions_m
        )
        if np.median(squares) < np.median(best):
            best = squares
    deviation_m = (
        1.4826 * (1 + 5 / max(count - 3, 1)) * np.sqrt(np.median(best))
    )  # of a normal distribution
    is_used = (
        best <= (_SIGMAS * deviation_m) ** 2 + 1e-18
        if np.isfinite(best).all()
        else np.ones(count, bool)
    )
    motion = similarity_fit(positions_m[is_used], centres_model[is_used])
    used = int(is_used.sum())
    squares = _squares(motion, centres_model, positions_m)[is_used]
    per_axis_m = np.sqrt(squares.sum() / max(3 * used - 7, 1))  # seven numbers were fitted
    spread_m = motion[0] * np.linalg.norm(
        centres_model[is_used] - centres_model[is_used].mean(axis=0)
    )
    return CameraAlignment(
        *motion, is_used, float(np.sqrt(squares.mean())), float(per_axis_m / spread_m)
    )


def _squares(motion: tuple[float, Float, Float], source: Float, target: Float) -> Float:
    scale, R, t = motion
    return np.asarray(((scale * source @ R.T + t - target) ** 2).sum(axis=1))


def _check_spread(centres: Float) -> None:
    if len(centres) < 4:
        raise DataError(
            f"{len(centres)} pictures with a place: at least 4 give a scale; fly more pictures"
        )
    spreads = np.linalg.svd(centres - centres.mean(axis=0), compute_uv=False)
    if spreads[1] < _LEAST_WIDTH * spreads[0]:
        raise DataError(
            "the pictures were taken along one line, about which the map could turn as it likes; "
            "fly a second strip beside the first, or one across"
        )
