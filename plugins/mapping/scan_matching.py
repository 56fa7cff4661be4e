"""Matching of a scan pair to a submap of earlier pairs (Mascaro 2020, Sec. 4.2, step 3)."""

from collections import deque
from collections.abc import Callable

import numpy as np
import small_gicp
from executive_plugins.mapping.pose_constraint import PoseConstraint
from executive_plugins.mapping.scan_pair import SinglePrecision
from executive_plugins.mapping.settings import ScanMatchingSettings

from executive.arrays import Float
from executive.geometry.pose import inverse, transform
from executive.geometry.rotation import angle_between


class ScanMatcher:
    """Keeps the last pairs, thinned, and matches the next one by generalised ICP."""

    def __init__(self, settings: ScanMatchingSettings) -> None:
        self._settings = settings
        self._pairs: deque[tuple[int, Float]] = deque(maxlen=settings.pairs)

    def match(
        self, points_cabin: SinglePrecision, T_map_cabin: Float, pose_of: Callable[[int], Float]
    ) -> PoseConstraint | None:
        """Return the pair's pose in the previous node; None without a submap or a reliable match.

        On open ground a pair constrains height, roll and pitch well, and heading and horizontal
        position badly. The covariance reflects this: it is the inverse Hessian of the fit, scaled
        by a factor that was measured against known poses.

        Args:
            points_cabin: The pair's points [m], shape (N, 3).
            T_map_cabin: Predicted pose of the pair, shape (4, 4).
            pose_of: T_map_cabin of earlier nodes by number.
        """
        s = self._settings
        if not self._pairs or not len(points_cabin):
            return None
        T_before_map = inverse(pose_of(self._pairs[-1][0]))
        around = np.vstack(
            [transform(T_before_map @ pose_of(node), points) for node, points in self._pairs]
        )
        submap, tree = small_gicp.preprocess_points(around, s.submap_voxel_m, s.neighbours, 1)
        pair, _ = small_gicp.preprocess_points(
            points_cabin.astype(np.float64), s.pair_voxel_m, s.neighbours, 1
        )
        guess = T_before_map @ T_map_cabin
        result = small_gicp.align(
            submap,
            pair,
            tree,
            guess,
            max_correspondence_distance=s.max_distance_m,
            num_threads=1,
            max_iterations=20,
        )
        return self._accepted(result, pair.size(), guess)

    def add(self, node: int, points_cabin: SinglePrecision) -> None:
        """Add a node's pair to the submap; the oldest pair leaves it."""
        if len(points_cabin):
            thinned = small_gicp.voxelgrid_sampling(
                points_cabin.astype(np.float64), self._settings.pair_voxel_m, 1
            )
            self._pairs.append((node, thinned.points()[:, :3]))

    def forget(self) -> None:
        """Start a new submap."""
        self._pairs.clear()

    def _accepted(
        self, result: small_gicp.RegistrationResult, size: int, guess: Float
    ) -> PoseConstraint | None:
        s, T = self._settings, np.array(result.T_target_source)
        if not (
            result.converged
            and result.num_inliers >= s.least_inliers * size
            and np.isfinite(T).all()
        ):
            return None
        shift_m = np.linalg.norm(T[:3, 3] - guess[:3, 3])
        if shift_m > s.max_shift_m or angle_between(T[:3, :3], guess[:3, :3]) > s.max_turn_rad:
            return None
        H = np.array(result.H)
        if not np.isfinite(H).all() or _is_singular(H):
            return None
        return PoseConstraint(
            T, s.covariance_factor * np.linalg.inv(H) + s.least_std_m**2 * np.eye(6)
        )


def _is_singular(H: Float) -> bool:
    """Return whether a symmetric matrix has no inverse within rounding, or is not positive."""
    least, *_, most = np.linalg.eigvalsh(H)
    return bool(least <= len(H) * np.finfo(np.float64).eps * most)
