"""The straight path of the open gripper from above down to a grasp, checked against the cloud."""

import numpy as np

from executive.arrays import Float
from executive.geometry.convex import depth_inside, half_spaces
from executive.geometry.pose import inverse, transform
from executive.machine.gripper import Gripper

_STEP_M = 0.12  # between checked poses
_STRAIGHT_RAD = 0.05  # an approach this close to the path was checked by the push already


class ApproachPath:
    """The polyhedra of the open gripper, checked in poses along a straight path."""

    def __init__(self, gripper: Gripper, scale: float = 1.0) -> None:
        """Prepare the parts; `scale` is a factor on the step, for a gripper of another size."""
        self._step_m = scale * _STEP_M
        hulls = [hull for parts in gripper.hulls(gripper.open_rad).values() for hull in parts]
        self._parts = [(hull.min(axis=0), hull.max(axis=0), half_spaces(hull)) for hull in hulls]
        self._reach_m = max(float(np.linalg.norm(hull, axis=1).max()) for hull in hulls)

    def depth_m(self, points: Float, T_points_gripper: Float) -> float:
        """Return how deep the deepest of the points (N, 3) is in palm or open jaws [m].

        It is negative if all points are outside, −inf if none is near.
        """
        near = points[np.linalg.norm(points - T_points_gripper[:3, 3], axis=1) < self._reach_m]
        local = transform(inverse(T_points_gripper), near)
        deepest = -np.inf
        for low, high, faces in self._parts:
            # Only the few points in the bounding box are compared with the faces.
            boxed = local[((local >= low) & (local <= high)).all(axis=1)]
            deepest = max(deepest, float(depth_inside(faces, boxed).max(initial=-np.inf)))
        return deepest

    def is_free(
        self, points: Float, T_points_gripper: Float, up: Float, length_m: float, depth_m: float
    ) -> bool:
        """Return whether the open gripper stays clear of the points on its straight way down.

        Args:
            points: The cloud [m], shape (N, 3).
            T_points_gripper: Pose at the end of the path, shape (4, 4).
            up: Unit vector against the direction of motion, shape (3,).
            length_m: Length of the path [m].
            depth_m: Depth of a point in the gripper that is tolerated as noise [m].
        """
        is_straight = float(-up @ T_points_gripper[:3, 0]) > np.cos(_STRAIGHT_RAD)
        steps = 0 if is_straight else int(np.ceil(length_m / self._step_m))
        for height in np.linspace(0.0, length_m, steps + 1) if steps else (0.0,):
            T = T_points_gripper.copy()
            T[:3, 3] += height * up
            if self.depth_m(points, T) > depth_m:
                return False
        return True
