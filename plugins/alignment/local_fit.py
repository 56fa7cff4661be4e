"""One local fit of a cloud to another, its measure, and the gate that both aligners share."""

import numpy as np
from executive_plugins.alignment.closeness import Closeness, measure, weak_direction
from executive_plugins.alignment.gauss_newton import Rule, descend
from executive_plugins.alignment.settings import AlignmentSettings
from executive_plugins.alignment.surface import HOLDS, Surface
from executive_plugins.alignment.thinning import MOST, grid_for

from executive.arrays import Float, Int
from executive.clock import wall_s
from executive.errors import DataError
from executive.geometry.pose import inverse, transform
from executive.messages.alignment import Alignment, Uncertainty
from executive.messages.cloud import Cloud

# Points of the source in a fit that is not the last: enough for the basin of the last.
_MOST_COARSE = 2_500
_NEARLY_M, _SETTLED_M = 1e-3, 1e-4  # points that move less end a fit, and the last one
_FARTHEST = 3  # largest travel of a point in reaches: a smooth surface may slide along itself


def fit(
    kind: str,
    settings: AlignmentSettings,
    target: Cloud,
    source: Cloud,
    T_guess: Float,
    max_distance_m: float,
) -> Alignment:
    """Thin both clouds, optimise, measure on the source's points, pass the gate.

    Coordinates are taken about the target's centroid, so that a map in national coordinates keeps
    its digits.

    Args:
        kind: `GICP` or `PLANE_ICP`.
        settings: Resolution and gate.
        target: The cloud that stays.
        source: The cloud that is moved.
        T_guess: T_target_source to begin with, shape (4, 4).
        max_distance_m: Reach of correspondences [m].

    Returns:
        The motion; refused, with the guess, if a cloud is too small.

    Raises:
        DataError: If the distance is not positive or the guess is no rigid pose.
    """
    _check(T_guess, max_distance_m)
    begun_s = wall_s()
    if min(len(target), len(source)) < settings.min_points:
        reason = (
            f"too few points: target {len(target)}, source {len(source)}, need "
            f"{settings.min_points} each"
        )
        return Alignment(T_guess, False, reason, 0.0, 0.0)
    centre = target.points.mean(axis=0)
    T_centre = np.eye(4)
    T_centre[:3, 3] = -centre
    is_near = _within_reach(target.points, transform(T_guess, source.points), max_distance_m)
    near = target.points.take(np.flatnonzero(is_near), axis=0) - centre
    moved = transform(T_centre @ T_guess, source.points)
    if len(near) < settings.min_points:
        return Alignment(
            T_guess, False, "no target within reach of the source at the guess", 0.0, 0.0
        )
    grid_m = grid_for(moved, settings.voxel_m)
    surface = Surface.thinned(near, settings.voxel_m, settings.neighbours)
    thin = Surface.thinned(moved, grid_m, settings.neighbours)
    step = _optimise(kind, settings, surface, thin, max_distance_m)
    T = inverse(T_centre) @ step @ T_centre @ T_guess
    fitted = transform(step, thin.points)
    lies = measure(near, surface, fitted, grid_m, settings)
    travel_m = float(np.linalg.norm(fitted - thin.points, axis=1).max())
    accepted, reason = _judge(settings, lies, travel_m, max_distance_m)
    doubt = lies.uncertainty() if accepted else None
    if doubt is not None:
        doubt = Uncertainty(doubt.covariance, doubt.centre + centre)
        reason += weak_direction(doubt)
    return Alignment(
        T,
        accepted,
        reason,
        lies.rmse_m,
        lies.overlap,
        timings_ms={"total": (wall_s() - begun_s) * 1e3},
        uncertainty=doubt,
    )


def compile_fit() -> None:
    """Compile the inner loops, so that no cloud has to wait for them."""
    corners = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    surface = Surface.thinned(corners, 0.5, len(corners))
    planes = surface.planes(np.arange(len(corners)))
    descend(surface, corners, planes, np.eye(4), Rule(True, 1.0, 1.0, HOLDS, 1.0, 1, 1))


def _check(T_guess: Float, max_distance_m: float) -> None:
    if not max_distance_m > 0:
        raise DataError(f"correspondences need a positive reach, got {max_distance_m} m")
    R = np.asarray(T_guess)[:3, :3]
    if (
        np.shape(T_guess) != (4, 4)
        or not np.allclose(R @ R.T, np.eye(3), atol=1e-4)
        or np.linalg.det(R) < 0
    ):
        raise DataError(
            "the guess is no rigid pose: a 4×4 matrix with an orthonormal, right-handed rotation"
        )


def _within_reach(points: Float, others: Float, distance_m: float) -> Float:
    """Return which points are in the box about the others, widened on all sides, shape (N,).

    Axis by axis: reductions along rows of three take five times as long.
    """
    is_inside = np.ones(len(points), dtype=bool)
    for along, beside in zip(points.T, others.T, strict=True):
        low, high = beside.min() - distance_m, beside.max() + distance_m
        is_inside &= (along >= low) & (along <= high)
    return is_inside


def _optimise(
    kind: str,
    settings: AlignmentSettings,
    target: Surface,
    source: Surface,
    max_distance_m: float,
) -> Float:
    """Fit within the whole reach, then twice to what overlaps; return the motion.

    The last reach is half of the gate's distance. Where the target's points are farther apart than
    that, it is half of the radius over which its plane was fitted: nearer than that a point of the
    same surface finds a partner only where a line of the target's scan happens to run, and the fit
    would be drawn from line to line.

    The first fit is generalised ICP for either kind: point-to-plane leaves a smooth stone's basin
    from afar. Of a large source, few points are taken before the last fit.
    """
    dense_m, is_generalised = 0.5 * settings.gate_distance_m, kind == "GICP"
    every, few = _some(source, MOST), _some(source, _MOST_COARSE)
    T = np.eye(4)
    for rows, generalised, near_m, holds, settled_m in (
        (few, True, max_distance_m, HOLDS, _NEARLY_M),
        (few, is_generalised, 2 * dense_m, 2 * HOLDS, _NEARLY_M),
        (every, is_generalised, dense_m, HOLDS, _SETTLED_M),
    ):
        limits = settings.max_iterations, settings.min_points
        rule = Rule(generalised, max_distance_m, near_m, holds, settled_m, *limits)
        T = descend(target, source.points.take(rows, axis=0), source.planes(rows), T, rule)
    return T


def _some(surface: Surface, most: int) -> Int:
    """Return rows of so many points of a surface at most, evenly taken."""
    return np.arange(0, len(surface), -(-len(surface) // most))


def _judge(
    settings: AlignmentSettings, lies: Closeness, travel_m: float, max_distance_m: float
) -> tuple[bool, str]:
    faults = []
    if travel_m > _FARTHEST * max_distance_m:
        faults.append(
            f"a point moved by {travel_m:.2f} m, more than {_FARTHEST} times the reach: "
            "it slid away"
        )
    if lies.overlap < settings.min_overlap:
        faults.append(f"overlap {lies.overlap:.2f} below {settings.min_overlap}")
    told = f"rmse {lies.rmse_m * 100:.1f} cm"
    judged_m = lies.dense_m if settings.discount_gaps else lies.judged_m
    if lies.dense_m < 0.99 * lies.rmse_m:
        told += f", {lies.dense_m * 100:.1f} cm without the target's gaps"
    if judged_m > settings.max_rmse_m:
        cure = " (discount_gaps accepts it)" if lies.dense_m <= settings.max_rmse_m else ""
        faults.append(f"{told} above {settings.max_rmse_m * 100:.1f} cm{cure}")
    return not faults, "; ".join(faults) or f"{told}, overlap {lies.overlap:.2f}"
