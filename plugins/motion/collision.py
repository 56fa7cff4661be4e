"""Whether postures of the arm hit the machine, the surroundings, or both with what is held."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from executive.arrays import Bool, Float
from executive.geometry.pose import inverse, transform
from plugins.motion.chain import link_frames
from plugins.motion.convex import Convex
from plugins.motion.obstacles import Obstacles
from plugins.motion.self_collision import SelfCollision
from robot_models.machine import Machine


@dataclass(frozen=True, slots=True)
class Hit:
    """A collision: at which of the postures, and of what with what."""

    posture: int
    what: str


class CollisionCheck:
    """One arm, one opening of the jaws, one held stone or none, one set of obstacles.

    The chassis and the cabin are not tested against the surroundings: the former stands in them and the latter turns
    above them. A body may go into the points by a tolerance: a map is noisy, and a stone rests on the ground. Points that
    are inside a body in the first posture of all (`start`) are excused: the machine is there already.
    """

    def __init__(
        self,
        machine: Machine,
        bodies: Sequence[Convex],
        obstacles: Obstacles,
        start: Float,
        jaw_rad: float,
        held: Convex | None,
        tolerance_m: float,
        clearance_m: float,
    ) -> None:
        self._machine = machine
        self._obstacles = obstacles
        self._jaw_rad = jaw_rad
        self._tolerance_m = tolerance_m
        self._machine_check = SelfCollision(machine, bodies, clearance_m, held)
        fixed = {machine.base_link, machine.cabin_link}
        self._bodies = [body for body in bodies if body.link not in fixed]
        self._bodies += [held] if held is not None else []
        self._excused = self._inside(link_frames(machine, start[None], jaw_rad))

    def first_hit(self, q: Float) -> Hit | None:
        """Return the first collision along postures (K, n), or None."""
        frames = link_frames(self._machine, q, self._jaw_rad)
        outside, inside = self._surroundings_hit(frames), self._machine_check.first_hit(frames)
        if inside is not None and (outside is None or inside[0] <= outside.posture):
            return Hit(inside[0], f"{inside[1]} with {inside[2]}")
        return outside

    def machine_hit(self, q: Float) -> Hit | None:
        """Return the first collision along postures (K, n) of the machine with itself or with what it holds, or None."""
        hit = self._machine_check.first_hit(link_frames(self._machine, q, self._jaw_rad))
        return None if hit is None else Hit(hit[0], f"{hit[1]} with {hit[2]}")

    def _surroundings_hit(self, frames: dict[str, Float]) -> Hit | None:
        close = self._close_postures(frames)
        if not close.any():
            return None
        low, high = self._box(frames, close)
        near = self._obstacles.near(low, high, self._excused)
        for k, b in np.argwhere(close):
            body = self._bodies[b]
            T = frames[body.link][k]
            centre, radius = body.sphere
            points = near.around(transform(T, centre), radius)
            depth = float(body.depths(transform(inverse(T), points)).max(initial=-np.inf))
            if depth > self._tolerance_m:
                return Hit(int(k), f"{body.name} with the surroundings ({depth:.2f} m deep)")
        return None

    def _close_postures(self, frames: dict[str, Float]) -> Bool:
        """Tell which body comes low over the height map in which posture, shape (K, bodies)."""
        close = np.zeros((len(frames[self._machine.base_link]), len(self._bodies)), dtype=bool)
        for b, body in enumerate(self._bodies):
            T = frames[body.link]
            points = body.samples @ T[:, :3, :3].transpose(0, 2, 1) + T[:, None, :3, 3]
            close[:, b] = self._obstacles.clearances(points).min(axis=1) < -self._tolerance_m
        return close

    def _box(self, frames: dict[str, Float], close: Bool) -> tuple[Float, Float]:
        spheres = [
            (transform(frames[self._bodies[b].link][k], self._bodies[b].sphere[0]), self._bodies[b].sphere[1])
            for k, b in np.argwhere(close)
        ]
        low = np.min([centre - radius for centre, radius in spheres], axis=0)
        return low, np.max([centre + radius for centre, radius in spheres], axis=0)

    def _inside(self, frames: dict[str, Float]) -> Bool:
        inside = np.zeros(len(self._obstacles.points), dtype=bool)
        for body in self._bodies:
            T = frames[body.link][0]
            centre, radius = body.sphere
            near = np.nonzero((np.abs(self._obstacles.points - transform(T, centre)) < radius).all(axis=1))[0]
            inside[near] |= body.depths(transform(inverse(T), self._obstacles.points[near])) > 0
        return inside
