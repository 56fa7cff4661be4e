"""Collisions of the machine with itself, and of a held stone with the machine, by FCL."""

from collections.abc import Mapping, Sequence

import fcl
import numpy as np
from executive_plugins.motion.convex_body import PLACING, ConvexBody
from executive_plugins.motion.separation import unseparated
from executive_plugins.physics.even_directions import even_directions

from executive.arrays import Float, Int
from executive.machine.gripper import SIDES
from executive.machine.machine import Machine

_DIRECTIONS = even_directions(200)


class SelfCollision:
    """All pairs of convex bodies that must keep a clearance; planes in between exclude most.

    Attributes:
        machine: Machine whose bodies are checked.
        bodies: The convex parts of all links, and the held stone if there is one.
    """

    def __init__(
        self,
        machine: Machine,
        bodies: Sequence[ConvexBody],
        clearance_m: float,
        held: ConvexBody | None = None,
    ) -> None:
        self.machine = machine
        self.bodies = tuple(bodies) if held is None else (*bodies, held)
        self._clearance_m = clearance_m
        names = [body.name for body in self.bodies]
        pairs = {frozenset(pair) for pair in machine.collision_pairs}
        if held is not None:
            holders = {machine.gripper_link, *SIDES}
            pairs |= {frozenset((link, held.name)) for link in machine.links if link not in holders}
        indices = [
            (i, j)
            for i, a in enumerate(names)
            for j, b in enumerate(names[:i])
            if frozenset((a, b)) in pairs
        ]
        self._pairs = np.array(indices, dtype=np.int64).reshape(-1, 2)
        self._links = tuple(dict.fromkeys(body.link for body in self.bodies))
        self._owners = np.array([self._links.index(body.link) for body in self.bodies])
        self._corners = np.vstack([body.corners for body in self.bodies])
        self._starts = np.cumsum([0, *(len(body.corners) for body in self.bodies)])

    def first_hit(self, frames: Mapping[str, Float]) -> tuple[int, str, str] | None:
        """Return the first posture in which two bodies are too close, and their names, or None.

        Args:
            frames: T_base_link of every link for each posture, shape (K, 4, 4) each.
        """
        for k, pair in self._near_pairs(frames).tolist():
            a, b = (self.bodies[i] for i in self._pairs[pair])
            if _gap_m(a, frames[a.link][k], b, frames[b.link][k]) < self._clearance_m:
                return k, a.name, b.name
        return None

    def _near_pairs(self, frames: Mapping[str, Float]) -> Int:
        """Return postures and pairs that may be too close, in the order of the postures, (M, 2)."""
        of_links = np.array([frames[link] for link in self._links])
        return unseparated(
            of_links, self._owners, self._corners, self._starts, self._pairs, self._clearance_m
        )


def _gap_m(a: ConvexBody, T_a: Float, b: ConvexBody, T_b: Float) -> float:
    """Return the distance of two bodies at poses [m]; 0 or less where they overlap."""
    with PLACING:
        for body, T in ((a, T_a), (b, T_b)):
            body.placed.setTransform(fcl.Transform(T[:3, :3], T[:3, 3]))
        result = fcl.DistanceResult()
        return float(fcl.distance(a.placed, b.placed, fcl.DistanceRequest(), result))


def machine_bodies(machine: Machine) -> list[ConvexBody]:
    """Return the convex parts of all links, in the order of the machine."""
    return [
        ConvexBody(name, shape.vertices, name)
        for name, link in machine.links.items()
        for shape in link.shapes
    ]


def held_body(machine: Machine, held_gripper: Float) -> ConvexBody:
    """Return the hull of a held stone's surface points (N, 3) in the gripper frame [m].

    Only the outermost points along 200 directions are used: the hull shrinks by about a centimetre
    and loses most of its facets.

    Raises:
        ShapeError: If the points span no volume.
    """
    outermost = np.unique((held_gripper @ _DIRECTIONS.T).argmax(axis=0))
    return ConvexBody(machine.gripper_link, held_gripper[outermost], "held_stone")
