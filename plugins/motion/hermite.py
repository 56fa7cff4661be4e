"""The paper's heuristic planner: waypoints along the ground normal, Hermite curves between."""

from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
from executive_plugins.motion.collision import CollisionCheck
from executive_plugins.motion.convex_body import ConvexBody
from executive_plugins.motion.forward_kinematics import link_frames
from executive_plugins.motion.ground import ground_normal
from executive_plugins.motion.height_survey import compile_survey
from executive_plugins.motion.held_limits import Levers, held_limits
from executive_plugins.motion.inverse_kinematics import InverseKinematics
from executive_plugins.motion.move import Move, NoPath
from executive_plugins.motion.obstacles import Obstacles
from executive_plugins.motion.oil_flow import OilFlow
from executive_plugins.motion.path_speeds import compile_speeds
from executive_plugins.motion.self_collision import SelfCollision, held_body, machine_bodies
from executive_plugins.motion.separation import compile_separation
from executive_plugins.motion.settings import HermiteSettings
from executive_plugins.motion.sweep import folding_sweep, sweep
from executive_plugins.motion.timing import Limits
from executive_plugins.motion.waypoints import Waypoints
from executive_plugins.motion.yielding_base import Request, YieldingBase

from executive.arrays import Float, checked
from executive.geometry.pose import inverse, transform
from executive.interfaces.motion import MotionPlanner
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.request import Around, MotionPlan, MoveRequest, PostureRequest
from executive.messages.trajectory import JointTrajectory

_BEYOND_REACH_M = 2.0  # obstacles farther beyond the reach are ignored
_NOTHING = Cloud("map", np.zeros((0, 3)))
_PATH_POINTS = 100  # number of points of the path that is displayed


class Hermite(MotionPlanner):
    """Plans moves and sweeps (Mascaro 2020, Sec. 6.1); deterministic and stateless."""

    Settings = HermiteSettings
    latency_s: ClassVar[Mapping[str, float]] = {"move": 0.1, "swing": 0.1, "move_joints": 0.1}
    is_stateless = True

    def __init__(self, settings: HermiteSettings, machine: Machine) -> None:
        self._settings = settings
        self._machine = machine

    def start(self) -> None:
        machine, settings = self._machine, self._settings
        self._kinematics = Kinematics(machine)
        self._ik = InverseKinematics(settings.inverse_kinematics, machine, self._kinematics)
        self._waypoints = Waypoints(machine, self._kinematics, self._ik)
        self._base = YieldingBase(machine, settings.lift_capacity)
        self._bodies = machine_bodies(machine)
        self._machine_check = SelfCollision(machine, self._bodies, settings.machine_clearance)
        compile_speeds(len(machine.joints))
        compile_survey()
        compile_separation()
        self._ik.compile()

    def reach(self, T_base_gripper: Float, seed: Float) -> Float | None:
        T_base_gripper = checked("T_base_gripper", T_base_gripper, 4, 4)
        return self._ik.solve(T_base_gripper, self._checked(seed), self._is_free)

    def move(self, request: MoveRequest) -> MotionPlan:
        start = self._checked(request.start)
        goal = inverse(request.T_map_base) @ request.T_map_gripper
        obstacles = self._obstacles(request.obstacles, request.T_map_base)
        move = self._move(request, obstacles)
        if (hit := move.check.machine_hit(start[None])) is not None:
            return _refused(f"start: collision of {hit.what}")
        leave = move.leave(
            start, self._normal(obstacles, self._kinematics.gripper(start)), request.leave_m
        )
        if isinstance(leave, NoPath):
            return _refused(leave.reason)
        arrive = move.arrive(goal, leave.nodes[-1], self._normal(obstacles, goal), request.arrive_m)
        if isinstance(arrive, NoPath):
            return _refused(arrive.reason)
        trajectory = move.travel(leave, arrive)
        if isinstance(trajectory, NoPath):
            return _refused(trajectory.reason)
        return self._planned(trajectory, request.T_map_base)

    def swing(
        self, start: Float, angle_rad: float, duration_s: float, around: Around | None = None
    ) -> MotionPlan:
        start, turn = self._checked(start), self._machine.arm_names.index(self._machine.turn_joint)
        lower, upper = self._machine.lower[turn], self._machine.upper[turn]
        if not lower <= start[turn] - angle_rad / 2 <= start[turn] + angle_rad / 2 <= upper:
            return _refused(
                f"sweeping: the range of {self._machine.turn_joint} is {lower:.2f} to "
                f"{upper:.2f} rad"
            )
        if around is None:
            around = Around(np.eye(4), _NOTHING, self._machine.gripper.open_rad)
        return self._free_sweep(start, angle_rad, duration_s, around)

    def move_joints(self, request: PostureRequest) -> MotionPlan:
        start = self._checked(request.start)
        goal = self._ik.nearest_turn(self._checked(request.goal), start)
        for joint, wanted in zip(self._machine.joints, goal, strict=True):
            if not joint.lower <= wanted <= joint.upper:
                reach = f"the range of {joint.name} is {joint.lower:.2f} to {joint.upper:.2f}"
                return _refused(f"{joint.name} to {wanted:.2f}: {reach}")
        move = self._move(request, self._obstacles(request.obstacles, request.T_map_base))
        for what, posture in (("start", start), ("goal", goal)):
            if (hit := move.check.machine_hit(posture[None])) is not None:
                return _refused(f"{what}: collision of {hit.what}")
        trajectory = move.between(start, goal)
        if isinstance(trajectory, NoPath):
            return _refused(trajectory.reason)
        return self._planned(trajectory, request.T_map_base)

    def _free_sweep(
        self, start: Float, angle_rad: float, duration_s: float, around: Around
    ) -> MotionPlan:
        checks = self._sweep_checks(start, around)
        fold, reason = self._fold(start), ""
        limits = self._loaded(around)
        if around.held_gripper is not None:
            limits = self._held(limits, fold, around)
        ways = [(folding_sweep, angle_rad), (folding_sweep, -angle_rad), (sweep, angle_rad)]
        # Unseen ground is not taken for free: on an empty map the arm folds first.
        touching: JointTrajectory | None = None
        for way, turn_rad in ways if len(around.obstacles.points) else ways[-1:]:
            trajectory = way(self._machine, limits, fold, turn_rad, duration_s)
            contact = checks[0].first_hit_along(trajectory)
            if contact is not None:
                reason = f"sweeping: collision of {contact[1]} at fraction {contact[0]:.2f}"
            elif checks[1].first_hit_along(trajectory) is None:
                return self._planned(trajectory, around.T_map_base)
            elif touching is None:
                touching = trajectory
        if touching is None:
            return _refused(reason)
        return self._planned(touching, around.T_map_base)

    def _sweep_checks(self, start: Float, around: Around) -> list[CollisionCheck]:
        """Return the check for contacts, and one that keeps the clearance from the surroundings.

        A sweep is free of contacts. Maps, arms and stones are off by some centimetres, so that one
        which keeps the clearance as well is taken, if there is one.
        """
        machine_check = self._sweep_check(start, around)
        obstacles = self._obstacles(around.obstacles, around.T_map_base)
        settings = self._settings
        return [
            CollisionCheck(
                machine_check,
                obstacles,
                start,
                around.jaw_rad,
                settings.contact_tolerance,
                clearance_m,
            )
            for clearance_m in (0.0, settings.machine_clearance)
        ]

    def _move(self, request: MoveRequest | PostureRequest, obstacles: Obstacles) -> Move:
        settings = self._settings
        held = (
            None if request.held_gripper is None else held_body(self._machine, request.held_gripper)
        )
        machine_check = self._machine_check_for(request.start, request.jaw_rad, held)
        return Move(
            machine=self._machine,
            waypoints=self._waypoints,
            inverse_kinematics=self._ik,
            check=CollisionCheck(
                machine_check, obstacles, request.start, request.jaw_rad, settings.contact_tolerance
            ),
            obstacles=obstacles,
            reaching_gripper=self._reaching(request.jaw_rad, held),
            limits=self.limits(request),
            clearance_m=settings.clearance,
            least_arrival=settings.least_arrival,
            load=self._base.load(request),
            easing=self._base.easing(request),
        )

    def _sweep_check(self, start: Float, around: Around) -> SelfCollision:
        """Return the check of the machine with itself, and with a held stone if there is one."""
        if around.held_gripper is None:
            return self._machine_check
        held = held_body(self._machine, around.held_gripper)
        return self._machine_check_for(start, around.jaw_rad, held)

    def _machine_check_for(
        self, start: Float, jaw_rad: float, held: ConvexBody | None
    ) -> SelfCollision:
        """Return a check that keeps the clearance between parts of the machine.

        If the start is closer already, the check forbids contact only.
        """
        check = SelfCollision(self._machine, self._bodies, self._settings.machine_clearance, held)
        if check.first_hit(link_frames(self._machine, start[None], jaw_rad)) is None:
            return check
        return SelfCollision(self._machine, self._bodies, 0.0, held)

    def _obstacles(self, cloud: Cloud, T_map_base: Float) -> Obstacles:
        return Obstacles(
            transform(inverse(T_map_base), cloud.points), self._machine.reach_m + _BEYOND_REACH_M
        )

    def _normal(self, obstacles: Obstacles, T_base_gripper: Float) -> Float:
        return ground_normal(obstacles.points, T_base_gripper[:3, 3])

    def _reaching(self, jaw_rad: float, held: ConvexBody | None) -> Float:
        parts = [hull for hulls in self._machine.gripper.hulls(jaw_rad).values() for hull in hulls]
        return np.vstack(parts if held is None else [*parts, held.corners])

    def limits(self, request: MoveRequest | PostureRequest) -> Limits:
        """Return the limits that a motion keeps."""
        limits = self._loaded(request)
        if request.held_gripper is None:
            return limits
        if isinstance(request, PostureRequest):
            goal: Float | None = request.goal
        else:
            T_base_goal = inverse(request.T_map_base) @ request.T_map_gripper
            goal = self._ik.solve(T_base_goal, request.start)
        ends = [request.start] if goal is None else [request.start, goal]
        return self._held(limits, ends, request)

    def _held(self, limits: Limits, postures: Sequence[Float], request: Request) -> Limits:
        """Return the limits of a motion with the held stone of a request that passes postures."""
        levers = Levers.at(self._kinematics, *postures)
        return held_limits(limits, levers, self._settings, self._base.sway_s(request, postures))

    def _loaded(self, request: Request) -> Limits:
        """Return the machine's limits with the load of a request."""
        machine, share, load = self._machine, self._settings.speed, self._load(request)
        velocity, acceleration = (
            (1.0 - load) * empty + load * loaded
            for empty, loaded in (
                (machine.max_velocity, machine.loaded_max_velocity),
                (machine.max_acceleration, machine.loaded_max_acceleration),
            )
        )
        flow = None if self._settings.oil_flow == "free" else OilFlow.of(machine)
        return Limits(velocity * share, acceleration * share, machine.max_jerk, flow)

    def _load(self, request: Request) -> float:
        """Return the load of a request, from 0 for none to 1 for that of the loaded limits."""
        if request.held_gripper is None:
            return 0.0
        if request.held_kg is None or self._settings.load_limits == "fixed":
            return 1.0
        return float(np.clip(request.held_kg / self._machine.payload_kg, 0.0, 1.0))

    def _fold(self, start: Float) -> list[Float]:
        """Return postures from the present one to `scan`, without turning the cabin.

        They pass through `carry` if that is higher than the present posture.
        """
        turn = self._machine.arm_names.index(self._machine.turn_joint)
        postures = [start]
        for name in ("carry", "scan"):
            posture = self._ik.nearest_turn(self._machine.posture(name), start)
            posture[turn] = start[turn]
            if (
                name == "scan"
                or self._kinematics.gripper(posture)[2, 3] > self._kinematics.gripper(start)[2, 3]
            ):
                postures.append(posture)
        return postures

    def _is_free(self, q: Float) -> bool:
        return (
            self._machine_check.first_hit(
                link_frames(self._machine, q[None], self._machine.gripper.open_rad)
            )
            is None
        )

    def _planned(self, trajectory: JointTrajectory, T_map_base: Float) -> MotionPlan:
        every = max(1, len(trajectory.times_s) // _PATH_POINTS)
        frames = link_frames(self._machine, trajectory.position[::every], 0.0)
        return MotionPlan(
            trajectory, "", transform(T_map_base, frames[self._machine.gripper_link][:, :3, 3])
        )

    def _checked(self, q: Float) -> Float:
        return checked("the vector of arm positions", q, len(self._machine.joints))


def _refused(reason: str) -> MotionPlan:
    return MotionPlan(None, reason, np.zeros((0, 3)))
