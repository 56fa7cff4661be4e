"""From the state of an IMU on the cabin to what an estimator reports: cabin and chassis, in the map and in odometry."""

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import inverse, pose
from executive.messages.base_state import BaseState
from plugins.estimation.chassis import TurnJoint
from plugins.estimation.inertial_state import POSITION, ROTATION, InertialState, skew
from plugins.estimation.strapdown import report_motion

_POSE = np.ix_(np.r_[ROTATION, POSITION], np.r_[ROTATION, POSITION])


class CabinReport:
    """Reports states one after another; the odometry frame goes on by increments and never steps (REP-105)."""

    def __init__(self, T_imu_cabin: Float, turn: TurnJoint) -> None:
        self._T_imu_cabin = T_imu_cabin
        self._turn = turn
        self._T_odom_map = np.eye(4)
        self._moved: tuple[Float, Float] | None = None

    @staticmethod
    def unknown(stamp_s: float, status: str) -> BaseState:
        """Return a state that may not be used."""
        nowhere = np.eye(4)
        return BaseState(stamp_s, nowhere, nowhere, nowhere, np.zeros(3), np.zeros(3), 1e6 * np.eye(6), status)

    def correct(self, before: InertialState, after: InertialState) -> None:
        """Move the map under the odometry where a correction moves the IMU at one time (Nubert 2022, Eq. (11)).

        The paper does so when the satellites come back; here each correction does, large or small.
        """
        self._T_odom_map = self._T_odom_map @ _pose(before) @ inverse(_pose(after))

    def report(self, head: InertialState, P: Float, status: str) -> BaseState:
        """Return the state of the machine.

        Args:
            head: The IMU at the newest sample.
            P: Covariance of the head's error, shape (15, 15); the same array again is taken as the same covariance.
            status: How the estimator stands.
        """
        T_cabin_base = self._turn.T_cabin_base(head.stamp_s)
        R, p, v = head.R_map_imu, head.p_map_imu, head.v_map_imu
        poses = np.empty((4, 4)), np.empty((4, 4)), np.empty((4, 4))
        v_cabin, w_cabin = np.empty(3), np.empty(3)
        report_motion(R, p, v, head.rate, self._T_imu_cabin, T_cabin_base, self._T_odom_map, *poses, v_cabin, w_cabin)
        if self._moved is None or self._moved[0] is not P:
            self._moved = (P, self._covariance(head, P))
        covariance = self._moved[1]
        T_map_base, T_odom_base, T_map_cabin = poses
        return BaseState(head.stamp_s, T_map_base, T_odom_base, T_map_cabin, v_cabin, w_cabin, covariance, status)

    def _covariance(self, head: InertialState, P: Float) -> Float:
        """Move the covariance from the IMU, in its axes and the map's, to the cabin's origin and axes."""
        R_cabin_imu, arm = self._T_imu_cabin[:3, :3].T, self._T_imu_cabin[:3, 3]
        J = np.zeros((6, 6))
        J[:3, :3] = R_cabin_imu
        J[3:, :3] = -R_cabin_imu @ skew(arm)
        J[3:, 3:] = R_cabin_imu @ head.R_map_imu.T
        return np.asarray(J @ P[_POSE] @ J.T)


def _pose(state: InertialState) -> Float:
    return pose(state.R_map_imu, state.p_map_imu)
