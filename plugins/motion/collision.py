"""Collisions of the arm and a held stone with the machine and with the surroundings."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from executive_plugins.motion.convex_body import ConvexBody
from executive_plugins.motion.forward_kinematics import link_frames
from executive_plugins.motion.obstacles import Obstacles
from executive_plugins.motion.self_collision import SelfCollision
from scipy.spatial import cKDTree

from executive.arrays import Bool, Float, Int
from executive.geometry.pose import inverse, transform
from executive.messages.trajectory import JointTrajectory

_THIN = 0.5  # share of a thin body's depth at which a point in it counts as a collision
# Between checked postures the motion of the palm over the first and of the joints over the second
# add up to at most 1.
_CHECK_M = 0.12
_CHECK = 0.1  # [rad] or [m]
_NOISE_M = 0.02  # allowance for noise of the ground at the start
_RAISED = np.zeros((4, 4))
_RAISED[2, 3] = 1.0


@dataclass(frozen=True, slots=True)
class Hit:
    """A collision: index of the posture, and names of the colliding bodies."""

    posture: int
    what: str


class CollisionCheck:
    """Collision check for one jaw angle, one held stone or none, and one set of obstacles.

    The chassis is not checked against the surroundings, since it is in contact with them. A body
    may penetrate stones and ground by a tolerance, since maps are noisy and a stone rests on the
    ground. Points that are inside a body in the first posture (`start`) are ignored, since the
    machine is there already. The jaws may go as much deeper into the ground as they dig. With a
    clearance, a body keeps that distance from all that is above the ground, but for points that are
    nearer in the first posture.
    """

    def __init__(
        self,
        machine_check: SelfCollision,
        obstacles: Obstacles,
        start: Float,
        jaw_rad: float,
        tolerance_m: float,
        clearance_m: float = 0.0,
    ) -> None:
        self._machine = machine_check.machine
        self._machine_check = machine_check
        self._obstacles = obstacles
        self._jaw_rad = jaw_rad
        self._clearance_m = clearance_m
        self._most_depth_m = -clearance_m if clearance_m > 0.0 else tolerance_m
        self._bodies = [
            body for body in machine_check.bodies if body.link != self._machine.base_link
        ]
        frames = link_frames(self._machine, start[None], jaw_rad)
        low, sunk_m = self._survey(frames)
        self._excused = self._inside(frames, low)
        gripper = self._machine.gripper
        digs_m = np.array([gripper.digs_m * (one.link in gripper.links) for one in self._bodies])
        self._allowed_sinking_m = np.maximum(tolerance_m + digs_m, sunk_m[0] + _NOISE_M)

    def first_hit(self, q: Float) -> Hit | None:
        """Return the first collision along postures (K, n), or None."""
        frames = link_frames(self._machine, q, self._jaw_rad)
        outside, inside = self._surroundings_hit(frames), self._machine_check.first_hit(frames)
        if inside is not None and (outside is None or inside[0] <= outside.posture):
            return Hit(inside[0], f"{inside[1]} with {inside[2]}")
        return outside

    def first_hit_along(self, trajectory: JointTrajectory) -> tuple[float, str] | None:
        """Return the first collision: the share of the trajectory before it, and what collides."""
        q = self._dense(trajectory)
        hit = self.first_hit(q)
        return None if hit is None else (hit.posture / (len(q) - 1), hit.what)

    def machine_hit(self, q: Float) -> Hit | None:
        """Return the first collision of the machine with itself or its load, or None.

        Args:
            q: Postures, shape (K, n).
        """
        hit = self._machine_check.first_hit(link_frames(self._machine, q, self._jaw_rad))
        return None if hit is None else Hit(hit[0], f"{hit[1]} with {hit[2]}")

    def _dense(self, trajectory: JointTrajectory) -> Float:
        """Return postures of a trajectory that are close enough to each other, shape (K, n).

        Between its samples the joints move evenly, to 0.1 mrad.
        """
        q = trajectory.position
        palm = link_frames(self._machine, q, 0.0)[self._machine.gripper_link][:, :3, 3]
        steps = (
            np.linalg.norm(np.diff(palm, axis=0), axis=1) / _CHECK_M
            + np.abs(np.diff(q, axis=0)).max(axis=1) / _CHECK
        )
        passed = np.concatenate([[0.0], np.cumsum(steps)])
        wanted = np.linspace(0.0, passed[-1], max(2, int(np.ceil(passed[-1])) + 1))
        return np.stack([np.interp(wanted, passed, joint) for joint in q.T], axis=1)

    def _surroundings_hit(self, frames: dict[str, Float]) -> Hit | None:
        low, sunk_m = self._survey(frames)
        sunk = np.argwhere(sunk_m > self._allowed_sinking_m)
        first_sunk = int(sunk[0, 0]) if len(sunk) else len(low)
        for k, body, points, depths in self._depths(frames, low[:first_sunk]):
            depth = float(depths[~np.isin(points, self._excused)].max(initial=-np.inf))
            if depth > min(self._most_depth_m, _THIN * body.thickness_m):
                return Hit(k, f"{body.name} with the surroundings ({depth:.2f} m deep)")
        if not len(sunk):
            return None
        k, b = sunk[0]
        return Hit(int(k), f"{self._bodies[b].name} with the ground ({sunk_m[k, b]:.2f} m deep)")

    def _inside(self, frames: dict[str, Float], low: Bool) -> Int:
        near_m = -self._clearance_m
        inside = [points[depths > near_m] for _, _, points, depths in self._depths(frames, low)]
        return np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *inside]))

    def _depths(
        self, frames: dict[str, Float], low: Bool
    ) -> Iterator[tuple[int, ConvexBody, Int, Float]]:
        """Yield posture, body, indices of nearby points and their depths in the body.

        Only bodies below the height map are considered.
        """
        close = np.argwhere(low)
        if not len(close):
            return
        centres = np.array(
            [
                transform(frames[self._bodies[b].link][k], self._bodies[b].sphere[0])
                for k, b in close
            ]
        )
        radii = np.array([[self._bodies[b].sphere[1] + self._clearance_m] for _, b in close])
        near = self._obstacles.in_box((centres - radii).min(axis=0), (centres + radii).max(axis=0))
        tree = cKDTree(self._obstacles.points[near])
        for (k, b), centre, radius in zip(close.tolist(), centres, radii[:, 0], strict=True):
            body = self._bodies[b]
            points = near[np.sort(tree.query_ball_point(centre, radius)).astype(np.int64)]
            T_link_base = inverse(frames[body.link][k])
            yield (
                k,
                body,
                points,
                body.depths(transform(T_link_base, self._obstacles.points[points])),
            )

    def _survey(self, frames: dict[str, Float]) -> tuple[Bool, Float]:
        """Return which bodies are below the height map, and their depths in the ground [m].

        Both have the shape (K, bodies).
        """
        shape = (len(frames[self._machine.base_link]), len(self._bodies))
        is_low, sunk_m = np.zeros(shape, dtype=bool), np.full(shape, -np.inf)
        for b, body in enumerate(self._bodies):
            T = frames[body.link]
            centre, radius_m = body.sphere
            close = self._obstacles.close(T, (centre, radius_m + self._clearance_m))
            is_low[close, b], sunk_m[close, b] = self._obstacles.survey(T[close], body.samples)
            if self._clearance_m > 0.0:
                lower = T[close] - self._clearance_m * _RAISED
                is_low[close, b] |= self._obstacles.survey(lower, body.samples)[0]
        return is_low, sunk_m
