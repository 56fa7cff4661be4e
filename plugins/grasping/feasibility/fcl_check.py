"""Final check of a grasp with FCL: palm and open jaws as convex bodies against the cloud.

It is independent of the tables and polyhedra that found the grasp.
"""

import fcl
import numpy as np
from executive_plugins.physics.fcl_convex import fcl_convex
from scipy.spatial import HalfspaceIntersection, QhullError

from executive.arrays import Float
from executive.geometry.convex import half_spaces
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import inverse, transform
from executive.machine.gripper import Gripper

_POINT = 1e-3  # radius of the ball that represents a point, over the tolerated depth
_REQUEST = fcl.CollisionRequest()


class FclCheck:
    """The open gripper at a pose, against points.

    The parts are shrunk by the depth that points may have, and FCL only reports whether they touch:
    the depths that it returns for a ball in a polyhedron are too large by up to a third.
    """

    def __init__(self, gripper: Gripper, allowed_m: float) -> None:
        """Prepare the parts.

        Args:
            gripper: The gripper, checked with open jaws.
            allowed_m: Depth of a point in a part that is tolerated as noise [m].
        """
        hulls = [hull for parts in gripper.hulls(gripper.open_rad).values() for hull in parts]
        cores = [core for hull in hulls if (core := _shrunk(hull, allowed_m)) is not None]
        self._bodies = [
            (core.min(axis=0), core.max(axis=0), fcl.CollisionObject(fcl_convex(*hull_mesh(core))))
            for core in cores
        ]
        # One for all points: each object made leaks 32 bytes.
        self._ball = fcl.CollisionObject(fcl.Sphere(_POINT * allowed_m))

    def is_free(self, points: Float, T_points_gripper: Float) -> bool:
        """Return whether none of the points (N, 3) is deeper in palm or open jaws than allowed."""
        local = transform(inverse(T_points_gripper), points)
        for low, high, body in self._bodies:
            near = local[((local >= low) & (local <= high)).all(axis=1)]
            for point in near:
                self._ball.setTranslation(point)
                if fcl.collide(body, self._ball, _REQUEST, fcl.CollisionResult()):
                    return False
        return True


def _shrunk(hull: Float, by_m: float) -> Float | None:
    """Return the corners of a polyhedron whose faces have moved inward; None if nothing is left."""
    faces = half_spaces(hull)
    try:
        return np.asarray(
            HalfspaceIntersection(
                np.column_stack([faces[:, :3], by_m - faces[:, 3]]), hull.mean(axis=0)
            ).intersections
        )
    except QhullError:
        return None
