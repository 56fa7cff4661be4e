"""Moves the chassis of a simulated machine: limits of driving, and braking without commands."""

from typing import TypedDict

import numpy as np

from executive.arrays import Float
from executive.errors import RobotError
from executive.machine.machine import Machine
from executive.messages.command import DRIVE_HOLD_S, START_TOLERANCE, Drive

_TOLERANCE = 1.001  # of limits, for rounding


class KeptBase(TypedDict):
    """Where the machine stands, and the curvature to which its wheels are steered."""

    pose: Float
    curvature: float


class BaseDriver:
    """Computes the pose of the chassis over the ground at each step.

    Speed and curvature approach what was commanded within the limits. Braking keeps the curvature,
    so that the machine stops on the arc that it is on. The wheels do not slip.

    Attributes:
        pose_map: x [m], y [m] and heading [rad] of the base frame, shape (3,).
        speed_m_s: Present speed along its x axis [m/s].
        curvature_1_m: Present curvature of its path [1/m].
    """

    def __init__(self, machine: Machine) -> None:
        self._machine, self._limits = machine, machine.driving
        self.pose_map: Float = np.zeros(3)
        self.speed_m_s = self.curvature_1_m = 0.0
        self._wanted = Drive(0.0, 0.0)
        self._left_s = 0.0

    @property
    def is_moving(self) -> bool:
        """Whether the chassis moves, or is about to."""
        return self.speed_m_s != 0.0 or (self._left_s > 0 and self._wanted.speed_m_s != 0.0)

    def command(self, drive: Drive, arm: Float, *, arm_moves: bool) -> None:
        """Drive from now on, for `DRIVE_HOLD_S`.

        Args:
            drive: The command.
            arm: Present positions of the arm's joints, shape (n,).
            arm_moves: Whether the arm follows a trajectory.

        Raises:
            RobotError: If the machine does not drive, a limit is exceeded, or the arm is not at
                rest in the posture for driving. A command to stand still is always taken.
        """
        if drive.speed_m_s != 0.0:
            self.check(drive, arm, arm_moves=arm_moves)
        self._wanted, self._left_s = drive, DRIVE_HOLD_S

    def check(self, drive: Drive, arm: Float, *, arm_moves: bool) -> None:
        """Refuse what `command` refuses, and do nothing else.

        Raises:
            RobotError: See `command`.
        """
        self._check(drive)
        self._check_arm(arm, arm_moves=arm_moves)

    def check_at_rest(self) -> None:
        """Let a motion of the arm pass only while the chassis stands.

        Raises:
            RobotError: If it moves.
        """
        if self.is_moving:
            raise RobotError(
                f"the chassis moves with {self.speed_m_s:.2f} m/s: the arm moves when it stands"
            )

    def stop(self) -> None:
        """Brake on the present arc; the last command counts no longer."""
        self._left_s = 0.0

    def advance(self, dt_s: float) -> Float:
        """Advance by a step; return the pose over the ground, shape (3,)."""
        if not self.is_moving or self._limits is None:
            return self.pose_map
        speed, curvature = 0.0, self.curvature_1_m
        if self._left_s > 0:
            speed, curvature = self._wanted.speed_m_s, self._wanted.curvature_1_m
        self._left_s = max(self._left_s - dt_s, 0.0)
        before_m_s = self.speed_m_s
        self.speed_m_s = _towards(before_m_s, speed, self._limits.max_acceleration_m_s2 * dt_s)
        self.curvature_1_m = _towards(
            self.curvature_1_m, curvature, self._limits.max_steering_1_ms * dt_s
        )
        way_m = 0.5 * (before_m_s + self.speed_m_s) * dt_s
        turn = way_m * self.curvature_1_m
        x, y, yaw = self.pose_map
        middle = yaw + turn / 2
        self.pose_map = np.array(
            [x + way_m * np.cos(middle), y + way_m * np.sin(middle), yaw + turn]
        )
        return self.pose_map

    def keep(self) -> KeptBase:
        """Return the state: a resumed machine stands where it was."""
        return {"pose": self.pose_map, "curvature": self.curvature_1_m}

    def restore(self, kept: KeptBase) -> None:
        """Take back what `keep` returned."""
        self.pose_map, self.curvature_1_m = np.array(kept["pose"]), float(kept["curvature"])
        self.speed_m_s = self._left_s = 0.0

    def _check(self, drive: Drive) -> None:
        limits = self._limits
        if limits is None:
            raise RobotError(
                f"{self._machine.name} does not drive: its robot.yaml has no block `driving`"
            )
        if not abs(drive.speed_m_s) <= _TOLERANCE * limits.max_speed_m_s:
            raise RobotError(
                f"a speed of {drive.speed_m_s:.2f} m/s: the limit is {limits.max_speed_m_s} m/s"
            )
        if not abs(drive.curvature_1_m) <= _TOLERANCE * limits.max_curvature_1_m:
            raise RobotError(
                f"a curvature of {drive.curvature_1_m:.3f} 1/m: the least radius is "
                f"{limits.least_radius_m} m"
            )

    def _check_arm(self, arm: Float, *, arm_moves: bool) -> None:
        if arm_moves:
            raise RobotError("the arm moves: the chassis drives when it is at rest")
        if off := travel_error(self._machine, arm):
            raise RobotError(off)


def travel_error(machine: Machine, arm: Float) -> str:
    """Return which joint is not in the posture for driving; empty if all are.

    Args:
        machine: A machine that drives.
        arm: Positions of the arm's joints, shape (n,).
    """
    if machine.driving is None:
        return ""
    away = arm - machine.posture(machine.driving.posture)
    turns = np.array([joint.kind == "continuous" for joint in machine.joints])
    away = np.where(turns, (away + np.pi) % (2 * np.pi) - np.pi, away)
    i = int(np.abs(away).argmax())
    if abs(away[i]) <= START_TOLERANCE:
        return ""
    return (
        f"{machine.arm_names[i]} is {away[i]:.2f} off the posture '{machine.driving.posture}', "
        "in which the machine drives"
    )


def _towards(value: float, goal: float, step: float) -> float:
    return float(np.clip(goal, value - step, value + step))
