"""One move: a straight start, a travel, a straight arrival, and their collision checks."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from executive_plugins.motion.carried_load import CarriedLoad
from executive_plugins.motion.collision import CollisionCheck
from executive_plugins.motion.easing import Easing
from executive_plugins.motion.forward_kinematics import link_frames
from executive_plugins.motion.inverse_kinematics import InverseKinematics
from executive_plugins.motion.obstacles import Obstacles
from executive_plugins.motion.path import HermitePath, path_through
from executive_plugins.motion.straight import time_line
from executive_plugins.motion.timing import Limits, time_path
from executive_plugins.motion.waypoints import Line, Waypoints, join, reach_below_m

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.machine.machine import Machine
from executive.messages.trajectory import JointTrajectory

_HIGHER_M = (0.0, 0.6, 1.2)  # added to the travelling height while the path is not free
_BESIDE_EACH_OTHER_M = 0.6  # tops closer than this need no lift between them
_BESIDE_M = 1.5  # margin of the cleared sector beyond the radii of the gripper
_BESIDE_RAD = 0.2  # margin of the cleared sector beyond its azimuths
_DRAWN_M = (0.0, 0.3, 0.6)  # a load is drawn in by so much more than the posture `carry` has it
_PARTS = (4, 8)  # into which a turn with a load is divided; the fewer, the smoother is the path
_ALIKE_COS = 0.9994  # directions within 2 deg count as the same


@dataclass(frozen=True, slots=True)
class NoPath:
    """Why a part of a move does not exist."""

    reason: str


@dataclass(frozen=True, eq=False)
class Move:
    """The parts of one move, in the base frame.

    Attributes:
        machine: Machine that moves.
        waypoints: Computes straight lines and lifts.
        inverse_kinematics: Computes the posture at the goal.
        check: Collision check.
        obstacles: The surroundings.
        reaching_gripper: Corners of the gripper and points of the held stone in its frame, shape
            (N, 3).
        limits: Limits of the joints.
        clearance_m: Height kept above obstacles while travelling.
        least_arrival: Share of the arrival that must be in reach.
        load: What is carried by a machine that may tip; None where tipping limits nothing.
        easing: How motions are eased on supports that yield; None where nothing eases them.
    """

    machine: Machine
    waypoints: Waypoints
    inverse_kinematics: InverseKinematics
    check: CollisionCheck
    obstacles: Obstacles
    reaching_gripper: Float
    limits: Limits
    clearance_m: float
    least_arrival: float
    load: CarriedLoad | None = None
    easing: Easing | None = None

    def leave(self, start: Float, normal: Float, length_m: float) -> Line | NoPath:
        """Move up from the start as far as the arm reaches; it fails only by a collision."""
        first: NoPath | None = None
        for direction in self._directions(self._frame(start), normal):
            line = self.waypoints.line_up(start, direction, length_m)
            hit = self.check.first_hit(line.nodes)
            if hit is None:
                return line
            first = first or NoPath(
                f"leaving: collision of {hit.what} at "
                f"{hit.posture / len(line.nodes):.0%} of the way up"
            )
        return first or NoPath("leaving: no upward direction")

    def arrive(
        self, T_base_goal: Float, seed: Float, normal: Float, length_m: float
    ) -> Line | NoPath:
        """Move straight down to the goal."""
        first: NoPath | None = None
        for direction in self._directions(T_base_goal, normal):
            for line in self._arrivals(T_base_goal, seed, direction, length_m):
                refusal = self._refusal(line, length_m)
                if refusal is None:
                    return line
                first = first or refusal
        return first or NoPath("goal out of reach")

    def travel(self, leave: Line, arrive: Line) -> JointTrajectory | NoPath:
        """Connect the two tops, with the least height and the shorter turn first.

        With a load, a path comes first on which the machine may lift it: drawn in, where the direct
        path is too far out. If there is none, the free path with the greatest lift capacity is
        returned; whoever carries the load judges that. No path bears more than its ends: where that
        is too little by far, no other one is sought.
        """
        first: NoPath | None = None
        best: tuple[float, JointTrajectory] | None = None
        for path in self._paths(leave, arrive):
            timed = self._timed(path)
            hit = self.check.first_hit_along(timed)
            if hit is not None:
                told = f"travelling: collision of {hit[1]} at fraction {hit[0]:.2f}"
                first = first or NoPath(told)
                continue
            if self.load is None or (spare_kg := self.load.spare_kg(timed.position)) >= 0.0:
                return timed
            ends_kg = min(self.load.spare_kg(line.nodes) for line in (leave, arrive))
            if spare_kg >= ends_kg:
                return timed
            best = (spare_kg, timed) if best is None or spare_kg > best[0] else best
            if self.load.is_hopeless(ends_kg):
                break
        return best[1] if best else first or NoPath("travelling: no path")

    def between(self, start: Float, goal: Float) -> JointTrajectory | NoPath:
        """Connect two postures: all joints at once where that is free, else over the obstacles."""
        direct = self._eased(lambda limits: time_line(self.machine.arm_names, start, goal, limits))
        if self.check.first_hit_along(direct) is None:
            return direct
        return self.travel(Line(start[None], 0.0), Line(goal[None], 0.0))

    def _paths(self, leave: Line, arrive: Line) -> Iterator[HermitePath]:
        a, b = leave.nodes[-1], arrive.nodes[-1]
        if np.linalg.norm((self._frame(a) - self._frame(b))[:3, 3]) < _BESIDE_EACH_OTHER_M:
            yield self._path(leave, [], arrive)
        for higher_m in _HIGHER_M:
            for shift_rad in self.waypoints.turn_shifts(a, b):
                turned = Line(self.waypoints.shifted(arrive.nodes, shift_rad), arrive.length_m)
                top_m = self._highest_between(a, turned.nodes[-1]) + self.clearance_m + higher_m
                tops = a, turned.nodes[-1]
                lifts = [self._lift(q, top_m) for q in tops]
                yield self._path(leave, lifts, turned)
                if self.load is not None:
                    over = tuple(
                        q if lift is None else lift for q, lift in zip(tops, lifts, strict=True)
                    )
                    yield from self._drawn_in(leave, lifts, over, turned)

    def _drawn_in(
        self, leave: Line, lifts: list[Float | None], over: tuple[Float, ...], arrive: Line
    ) -> Iterator[HermitePath]:
        """Yield paths that draw the load in while they turn, as far as it may be lifted there.

        Then follow some that draw it in before they turn, and put it out after that.
        """
        for parts in _PARTS:
            if (nodes := self._borne(over, parts)) is not None:
                yield self._path(leave, [lifts[0], *nodes, lifts[1]], arrive)
        for nearer_m in _DRAWN_M:
            radius_m = self.waypoints.carry_radius_m - nearer_m
            drawn = [self.waypoints.drawn(q, radius_m) for q in over]
            if any(q is not None for q in drawn):
                yield self._path(leave, [lifts[0], *drawn, lifts[1]], arrive)

    def _borne(self, over: tuple[Float, ...], parts: int) -> list[Float] | None:
        """Return postures from one to another in which the load may be lifted; None without."""
        if self.load is None:
            return None
        nearest_m, nodes = self.waypoints.carry_radius_m - _DRAWN_M[-1], list[Float]()
        for share in np.arange(1, parts) / parts:
            q = (1 - share) * over[0] + share * over[1]
            near = self.waypoints.drawn_until(q, nearest_m, self.load.may_pass)
            if near is None:
                return None
            nodes.append(near)
        return nodes

    def _lift(self, q: Float, lowest_m: float) -> Float | None:
        return self.waypoints.lift(
            q, lowest_m + reach_below_m(self._frame(q), self.reaching_gripper)
        )

    def _path(self, leave: Line, lifts: list[Float | None], arrive: Line) -> HermitePath:
        nodes, is_dense = join(leave, [q for q in lifts if q is not None], arrive)
        return path_through(nodes, is_dense, self.limits.velocity, self.limits.acceleration)

    def _highest_between(self, q_from: Float, q_to: Float) -> float:
        p, p_to = self._frame(q_from)[:2, 3], self._frame(q_to)[:2, 3]
        radii = (np.hypot(*p), np.hypot(*p_to))
        turn = self.machine.arm_names.index(self.machine.turn_joint)
        azimuth, azimuth_to = np.arctan2(p[1], p[0]), np.arctan2(p_to[1], p_to[0])
        swung = q_to[turn] - q_from[turn]
        swung += (azimuth_to - azimuth - swung + np.pi) % (2 * np.pi) - np.pi
        low, high = sorted((azimuth, azimuth + swung))
        sector = (low - _BESIDE_RAD, min(high + _BESIDE_RAD, low - _BESIDE_RAD + 2 * np.pi - 1e-6))
        return self.obstacles.highest(sector, (min(radii) - _BESIDE_M, max(radii) + _BESIDE_M))

    def _directions(self, T_base_gripper: Float, normal: Float) -> Iterator[Float]:
        """Yield the ground normal (Mascaro 2020, Sec. 6.1).

        Our additions follow: against the approach of the grasp, and vertically up.
        """
        given: list[Float] = []
        for direction in (normal, -T_base_gripper[:3, 0], np.array([0.0, 0.0, 1.0])):
            if all(direction @ other < _ALIKE_COS for other in given) and direction[2] > 0.5:
                given.append(direction)
                yield direction

    def _arrivals(
        self, T_base_goal: Float, seed: Float, direction: Float, length_m: float
    ) -> Iterator[Line]:
        """Yield lines from the goal upwards, then from the top downwards.

        They differ in the redundant freedom of the arm. Postures near the present one come first,
        so that the arm need not fold differently.
        """
        ik, T_top = self.inverse_kinematics, pose(t=direction * length_m) @ T_base_goal
        for find in (ik.track, lambda T, q: ik.solve(T, q, self._is_free)):
            q, top = find(T_base_goal, seed), find(T_top, seed)
            if q is not None:
                yield self.waypoints.line_up(q, direction, length_m)
            down = None if top is None else self.waypoints.line_up(top, -direction, length_m)
            if down is not None and down.length_m >= length_m - 1e-9:
                yield self.waypoints.line_up(down.nodes[-1], direction, length_m)

    def _is_free(self, q: Float) -> bool:
        return self.check.machine_hit(q[None]) is None

    def _refusal(self, line: Line, length_m: float) -> NoPath | None:
        if line.length_m < self.least_arrival * length_m:
            return NoPath(
                f"arriving: only {line.length_m:.2f} m of {length_m:.2f} m above the "
                "goal are in reach"
            )
        hit = self.check.first_hit(line.nodes)
        if hit is None:
            return None
        above = line.length_m * hit.posture / len(line.nodes)
        return NoPath(f"arriving: collision of {hit.what}, {above:.2f} m above the goal")

    def _timed(self, path: HermitePath) -> JointTrajectory:
        return self._eased(lambda limits: time_path(self.machine.arm_names, path, limits))

    def _eased(self, timed: Callable[[Limits], JointTrajectory]) -> JointTrajectory:
        """Return a motion with accelerations that a machine bears which may tip."""
        if self.easing is None:
            return timed(self.limits)
        return self.easing.eased(lambda share: timed(self.limits.softened(share)))

    def _frame(self, q: Float) -> Float:
        frames = link_frames(self.machine, q[None], 0.0)
        return np.asarray(frames[self.machine.gripper_link][0])
