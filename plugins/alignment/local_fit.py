"""One local fit of a cloud to another, its measure, and the gate that both aligners share."""

import numpy as np
import small_gicp
from executive_plugins.alignment.closeness import Closeness, measure, weak_direction
from executive_plugins.alignment.even_points import EvenPoints
from executive_plugins.alignment.settings import AlignmentSettings
from executive_plugins.alignment.thinning import grid_for

from executive.arrays import Float
from executive.clock import wall_s
from executive.errors import DataError
from executive.geometry.pose import inverse, transform
from executive.messages.alignment import Alignment, Uncertainty
from executive.messages.cloud import Cloud

# Points of the source in a generalised ICP that is not the last: enough for the basin of the last.
# Point-to-plane fits of so few ended in another basin, 0.2 degrees away.
_MOST_COARSE = 2_500
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
    surface, apart_m, step = _optimise(kind, settings, near, moved, grid_m, max_distance_m)
    T = inverse(T_centre) @ step @ T_centre @ T_guess
    fitted = transform(step, moved)
    lies = measure(near, surface, fitted, grid_m, settings, apart_m)
    travel_m = float(np.linalg.norm(fitted - moved, axis=1).max())
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
    target: Float,
    source: Float,
    grid_m: float,
    max_distance_m: float,
) -> tuple[small_gicp.PointCloud, float, Float]:
    """Fit within the whole reach, then twice to what overlaps, each time to faces that look alike.

    The last reaches are half of the gate's distance and more, and not less than the target's points
    are apart: nearer than that a point of the same surface finds a partner only where a line of the
    target's scan happens to run, and the fit would be drawn from line to line.

    Without that, the bottom and the far side of a stone, which the target does not show, pair with
    the ground and with the near side, and least squares turn the stone towards them. The first fit
    is generalised ICP for either kind: point-to-plane leaves a smooth stone's basin from afar. Of a
    large source, generalised ICP takes few points before the last fit.

    Returns:
        The target's surface, how far its points are apart [m], and the motion.
    """
    prepared, tree = small_gicp.preprocess_points(target, settings.voxel_m, settings.neighbours, 1)
    moving, _ = small_gicp.preprocess_points(source, grid_m, settings.neighbours, 1)
    few = moving
    if moving.size() > _MOST_COARSE:
        every = -(-moving.size() // _MOST_COARSE)
        few = _with_normals(np.array(moving.points()[::every, :3]), settings)
    even = EvenPoints(np.array(prepared.points()[:, :3]), settings.voxel_m)
    apart_m = even.spacing_m(settings.neighbours)
    last_m, T = max(0.5 * settings.gate_distance_m, apart_m), np.eye(4)
    second = few if kind == "GICP" else moving
    steps = (("GICP", max_distance_m, few), (kind, 2 * last_m, second), (kind, last_m, moving))
    for method, reach_m, cloud in steps:
        facing = _facing(prepared, even, cloud, T)
        if len(facing) < settings.min_points:
            break
        T = small_gicp.align(
            prepared,
            _moved_cloud(method, facing, settings),
            tree,
            T,
            registration_type=method,
            max_correspondence_distance=min(reach_m, max_distance_m),
            num_threads=1,  # sums in one order: the same bits each time
            max_iterations=settings.max_iterations,
            rotation_epsilon=1e-4,
            translation_epsilon=1e-4,
        ).T_target_source
    return prepared, apart_m, np.asarray(T, dtype=np.float64)


def _moved_cloud(method: str, points: Float, settings: AlignmentSettings) -> small_gicp.PointCloud:
    """Return what a method moves: of the source, distances to planes need the points alone."""
    return small_gicp.PointCloud(points) if method != "GICP" else _with_normals(points, settings)


def _with_normals(points: Float, settings: AlignmentSettings) -> small_gicp.PointCloud:
    cloud = small_gicp.PointCloud(points)
    small_gicp.estimate_normals_covariances(cloud, num_neighbors=settings.neighbours)
    return cloud


def _facing(
    target: small_gicp.PointCloud, even: EvenPoints, source: small_gicp.PointCloud, T: Float
) -> Float:
    """Return the source's points whose face is within 45 degrees of that of the nearest target
    point, shape (N, 3).
    """
    points, normals = np.array(source.points()[:, :3]), source.normals()[:, :3]
    nearest = even.nearest(transform(T, points))
    beside = target.normals().take(nearest, axis=0)[:, :3]
    cosines = np.einsum("ij,ij->i", normals @ T[:3, :3].T, beside)
    return points.take(np.flatnonzero(np.abs(cosines) > np.sqrt(0.5)), axis=0)


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
