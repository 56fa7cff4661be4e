"""What is watched while the machine moves: tracking, limits, efforts, pressure, the geofence."""

from collections.abc import Callable, Mapping

import numpy as np

from executive.arrays import Float
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.messages.command import Command, Follow
from executive.messages.joints import JointSample
from executive.watch.pressure import DrivePressure
from executive.watch.rules import (
    EFFORT,
    GEOFENCE,
    JOINT_LIMITS,
    PRESSURE,
    TRACKING,
    GeofenceRule,
    Rule,
)

_LIMIT_MARGIN = 0.02  # [rad] or [m] beyond a range: an end stop yields, a servo overshoots
_PATH_POINTS = 200  # of a path with which a stopped arm is compared
_FULL_EFFORT = 0.999  # of the largest effort: the drive cannot do more


class MotionWatch:
    """Compares the measured joints with the commanded ones, with their limits and with the fence.

    Args:
        machine: Limits and the declared tracking.
        T_map_base: Returns the pose of the chassis in the map, (4, 4); None while it is not known.
        has_efforts: Whether the robot measures efforts.
    """

    def __init__(
        self, machine: Machine, T_map_base: Callable[[], Float | None], *, has_efforts: bool = True
    ) -> None:
        self._machine, self._T_map_base = machine, T_map_base
        self._kinematics = Kinematics(machine)
        self._follow: Follow | None = None
        self._began_s: float  # this and the next two are set with `_follow`
        self._is_followed: bool
        self._path: Float
        self._pressure = DrivePressure(machine) if has_efforts else None

    def command(self, command: Command, now_s: float) -> None:
        """Take a command that the robot has accepted, at the machine's time [s]."""
        if isinstance(command, Follow):
            self._follow, self._began_s, self._is_followed = command, now_s, True
            times = np.linspace(0.0, command.trajectory.duration_s, _PATH_POINTS)
            self._path = np.array([command.trajectory.at(t)[0] for t in times])

    def stopped(self) -> None:
        """Take a stop along the path: the robot's reference is its own from then on."""
        self._is_followed = False

    def troubles(self, sample: JointSample, rules: Mapping[str, Rule]) -> dict[str, str]:
        """Return what is wrong with the motion, by condition; only what has a rule is looked at."""
        q = np.array([sample.of(name)[0] for name in self._machine.arm_names])
        found = {
            TRACKING: self._tracking(sample) if TRACKING in rules else "",
            JOINT_LIMITS: self._limits(q) if JOINT_LIMITS in rules else "",
            EFFORT: self._effort(sample) if EFFORT in rules else "",
            PRESSURE: self._lost_pressure(sample) if PRESSURE in rules else "",
        }
        fence = rules.get(GEOFENCE)
        if isinstance(fence, GeofenceRule):
            found[GEOFENCE] = self._fence(q, fence)
        return {condition: told for condition, told in found.items() if told}

    def _tracking(self, sample: JointSample) -> str:
        """Compare with the trajectory at the sample's time and at the declared lag before it."""
        if self._follow is None:
            return ""
        stance, trajectory = self._machine.stance, self._follow.trajectory
        measured = np.array([sample.of(name)[0] for name in trajectory.names])
        if self._is_followed:
            since_s = sample.stamp_s - self._began_s
            lags = (0.0, stance.tracking_lag_s)
            now, before = (trajectory.at(since_s - lag_s)[0] for lag_s in lags)
            low, high = np.minimum(now, before), np.maximum(now, before)
            off = np.maximum(low - measured, measured - high)
        else:  # after a stop, only the path is known, and not when the arm is where
            apart = np.abs(self._path - measured)
            off = apart[int(apart.max(axis=1).argmin())]
        i = int(off.argmax())
        if off[i] <= stance.tracking_error:
            return ""
        return f"{trajectory.names[i]} is {off[i]:.3f} off its path"

    def _limits(self, q: Float) -> str:
        beyond = np.maximum(self._machine.lower - q, q - self._machine.upper)
        i = int(beyond.argmax())
        if beyond[i] <= _LIMIT_MARGIN:
            return ""
        return f"{self._machine.arm_names[i]} is {beyond[i]:.3f} beyond its range"

    def _effort(self, sample: JointSample) -> str:
        for joint in self._machine.joints:
            effort = abs(sample.of(joint.name)[2])
            if effort >= _FULL_EFFORT * joint.max_effort:
                return f"{joint.name} needs its full effort"
        return ""

    def _lost_pressure(self, sample: JointSample) -> str:
        """Look at the drives' pressure while a path is followed and the tilt is known."""
        if self._pressure is None:
            return ""
        T_map_base = self._T_map_base()
        if self._follow is None or not self._is_followed or T_map_base is None:
            self._pressure.forget()
            return ""
        since_s = sample.stamp_s - self._began_s
        return self._pressure.lost(sample, self._follow, since_s, T_map_base[2, :3])

    def _fence(self, q: Float, rule: GeofenceRule) -> str:
        T_map_base = self._T_map_base()
        if T_map_base is None:
            return ""
        at = (T_map_base @ self._kinematics.gripper(q))[:2, 3] - np.array(rule.centre)
        away_m = float(np.linalg.norm(at))
        if away_m <= rule.radius:
            return ""
        return f"the gripper is {away_m:.2f} m from the centre, outside {rule.radius:.2f} m"
