"""Dead reckoning of a lidar between scans by gyroscope, turn joint and constant velocity."""

from collections import deque
from itertools import pairwise
from typing import TypeVar

import numpy as np
from executive_plugins.odometry.sensor_path import SensorPath

from executive.arrays import Float
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import about_axis, exp_so3, log_so3, skew
from executive.machine.rig import Rig
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.odometry import LidarIncrement

S = TypeVar("S")

_KEPT_S = 3.0  # longer than the odometry continues without an accepted scan
_FRESH_S = 0.05  # inertial samples further than this from a scan are not used for it
_ACCELERATION_M_S2 = 0.5  # of the chassis; the variance of its velocity grows with it
_FIRST_SPEED_M_S = 0.5  # standard deviation of the speed before the first increment


class DeadReckoning:
    """Rotates with the cabin's gyroscope about an axis that moves at constant velocity.

    Lidar odometry commonly assumes a constant velocity of the sensor. On a cabin that swings this
    does not hold: a lidar at 1.3 m from the axis changes its direction of motion all the time. The
    point on the axis does not. Without a gyroscope the last motion of the sensor is assumed to
    continue.
    """

    def __init__(self, machine: Rig, lidar: str) -> None:
        self._T_cabin_lidar = machine.sensors[lidar].T_link_sensor
        imus = [sensor for sensor in machine.sensors_of("imu") if sensor.link == machine.cabin_link]
        self._imu = imus[0].name if imus else None
        self._R_cabin_imu = imus[0].T_link_sensor[:3, :3] if imus else np.eye(3)
        self._turn_joint = machine.turn_joint
        self._axis = np.array([0.0, 0.0, 1.0])
        if machine.turn_joint is not None:
            self._axis = np.asarray(
                machine.joints[machine.arm_names.index(machine.turn_joint)].axis, dtype=float
            )
        self._rates: deque[tuple[float, Float]] = deque()
        self._turns: deque[tuple[float, float]] = deque()
        self._v_chassis = np.zeros(3)  # velocity of the point on the axis, chassis axes [m/s]
        self._P_speed = _FIRST_SPEED_M_S**2 * np.eye(3)  # covariance of its error [m²/s²]
        self._w_cabin = np.zeros(3)  # by the last increment [rad/s]; used without gyroscope

    def add_imu(self, sample: ImuSample) -> None:
        """Take a sample if it is of the cabin; it covers the time since the one before."""
        if sample.frame == self._imu:
            _append(self._rates, sample.stamp_s, self._R_cabin_imu @ sample.angular_velocity_rad_s)

    def add_joints(self, sample: JointSample) -> None:
        """Take the turn joint's position."""
        if self._turn_joint is not None:
            _append(self._turns, sample.stamp_s, sample.of(self._turn_joint)[0])

    def path(self, from_s: float, to_s: float) -> SensorPath:
        """Return the path of the lidar between two times [s]."""
        rates = [
            (stamp_s, rate) for stamp_s, rate in self._rates if from_s < stamp_s <= to_s + _FRESH_S
        ]
        if not rates or to_s - rates[-1][0] > _FRESH_S:
            rates = [(to_s, self._w_cabin)]
        stamps = [from_s, *(stamp_s for stamp_s, _ in rates if stamp_s < to_s), to_s]
        T = np.eye(4)
        poses = [T]
        for begin_s, end_s in pairwise(stamps):
            rate = next((rate for stamp_s, rate in rates if stamp_s >= end_s - 1e-9), rates[-1][1])
            T = T @ self._step(rate, 0.5 * (begin_s + end_s), end_s - begin_s)
            poses.append(T)
        T_lidar_cabin = inverse(self._T_cabin_lidar)
        return SensorPath.of(
            np.array(stamps), np.array([T_lidar_cabin @ T @ self._T_cabin_lidar for T in poses])
        )

    def _step(self, w_cabin: Float, middle_s: float, dt_s: float) -> Float:
        """Return the cabin's motion over a short time, in its frame at the start, shape (4, 4)."""
        half = exp_so3(0.5 * dt_s * w_cabin)
        v_cabin = self._R_chassis_cabin(middle_s).T @ self._v_chassis
        return pose(half @ half, dt_s * half @ v_cabin)

    def correct(self, increment: LidarIncrement) -> None:
        """Correct the chassis' velocity by a matched increment and its covariance (Kalman filter).

        In a direction that the scene constrains badly, the velocity stays as it is, so that a
        drifting match does not affect the next prediction.
        """
        T_cabin_lidar = self._T_cabin_lidar
        T = T_cabin_lidar @ increment.T_from_to @ inverse(T_cabin_lidar)
        rotation, dt_s = log_so3(T[:3, :3]), increment.to_s - increment.from_s
        R_chassis_middle = self._R_chassis_cabin(0.5 * (increment.from_s + increment.to_s))
        speed = R_chassis_middle @ exp_so3(-0.5 * rotation) @ T[:3, 3] / dt_s
        R_cabin_lidar, arm = T_cabin_lidar[:3, :3], T_cabin_lidar[:3, 3]
        # An error of the lidar's rotation moves the cabin's origin, too: lower half of the adjoint.
        J = R_chassis_middle @ np.hstack([skew(arm) @ R_cabin_lidar, R_cabin_lidar]) / dt_s
        P = self._P_speed + (_ACCELERATION_M_S2 * dt_s) ** 2 * np.eye(3)
        gain = np.linalg.solve(P + J @ increment.covariance @ J.T, P).T
        self._v_chassis = self._v_chassis + gain @ (speed - self._v_chassis)
        self._P_speed = P - gain @ P
        self._w_cabin = rotation / dt_s

    def _R_chassis_cabin(self, stamp_s: float) -> Float:
        if not self._turns:
            return np.eye(3)
        stamps, positions = zip(*self._turns, strict=True)
        return about_axis(self._axis, float(np.interp(stamp_s, stamps, positions)))


def _append(samples: deque[tuple[float, S]], stamp_s: float, value: S) -> None:
    """Append a sample if it is newer than all before, and drop samples older than `_KEPT_S`."""
    if samples and stamp_s <= samples[-1][0]:
        return
    samples.append((stamp_s, value))
    while samples[0][0] < stamp_s - _KEPT_S:
        samples.popleft()
