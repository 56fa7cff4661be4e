"""The peer: a plain fixed-lag smoother on GTSAM with an unknown heading, as its examples show it.

It has no gate, no condition for its start, no odometry and no threshold: a wide prior on heading
and velocity; a pose, a velocity and a bias for each fix; preintegrated inertial samples between
them; fixes with their declared covariance and lever arm.
"""

from collections import deque

import gtsam
import numpy as np
from gtsam.symbol_shorthand import B, V, X

from drawn_logs.measuring import IMU
from executive.arrays import Float
from executive.config import Settings
from executive.geometry.geodesy import enu_from_geodetic
from executive.interfaces.estimation import Estimator
from executive.machine.rig import Rig
from executive.machine.sensor import Imu
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.odometry import LidarIncrement

_TILT_STD, _HEADING_STD, _VELOCITY_STD = 0.3, np.pi, 10.0
_LEVELLING = 50  # samples whose mean force gives the first roll and pitch


class PlainSmootherSettings(Settings):
    """The lag, and the origin of the map."""

    datum: tuple[float, float, float]
    lag_s: float = 10.0


class PlainSmoother(Estimator):
    """A state for each fix; the newest one is carried on by the inertial samples since."""

    Settings = PlainSmootherSettings

    def __init__(self, settings: PlainSmootherSettings, rig: Rig) -> None:
        self._settings, self._rig = settings, rig

    def start(self) -> None:
        imu = self._rig.sensors[IMU]
        assert isinstance(imu, Imu)
        params = gtsam.PreintegrationCombinedParams.MakeSharedU(9.81)
        params.setGyroscopeCovariance(imu.gyro_noise_rad_s**2 / imu.rate_hz * np.eye(3))
        params.setAccelerometerCovariance(imu.accel_noise_m_s2**2 / imu.rate_hz * np.eye(3))
        params.setIntegrationCovariance(1e-8 * np.eye(3))
        params.setBiasOmegaCovariance(imu.gyro_walk_rad_s**2 * np.eye(3))
        params.setBiasAccCovariance(imu.accel_walk_m_s2**2 * np.eye(3))
        self._params = params
        self._bias_std = np.repeat([imu.accel_bias_m_s2, imu.gyro_bias_rad_s], 3)
        isam = gtsam.ISAM2Params()
        isam.setFactorization("QR")  # Cholesky fails on biases that hardly walk
        self._smoother = gtsam.IncrementalFixedLagSmoother(self._settings.lag_s, isam)
        self._bias = gtsam.imuBias.ConstantBias()
        self._samples: deque[ImuSample] = deque(maxlen=_LEVELLING)  # newer than the newest state
        self._ahead = gtsam.PreintegratedCombinedMeasurements(params, self._bias)
        self._number, self._at_s = -1, -np.inf
        self._nav: gtsam.NavState | None = None

    def add_imu(self, sample: ImuSample) -> None:
        if self._samples and self._number >= 0:
            _integrate(self._ahead, sample, sample.stamp_s - self._samples[-1].stamp_s)
        self._samples.append(sample)

    def add_gnss(self, fix: GnssFix) -> None:
        if not self._samples or fix.stamp_s < self._at_s:
            return
        p_map = enu_from_geodetic(fix.geodetic, np.array(self._settings.datum))
        graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        if self._number < 0:
            self._begin(fix.stamp_s, p_map, graph, values)
        else:
            self._step(fix.stamp_s, graph, values)
        n = self._number
        arm = self._rig.sensors[fix.antenna].T_link_sensor[:3, 3]
        noise = gtsam.noiseModel.Gaussian.Covariance(fix.covariance_enu_m2)
        graph.add(gtsam.GPSFactorArm(X(n), p_map, arm, noise))
        stamps = {symbol(n): fix.stamp_s for symbol in (X, V, B)} if values.size() else {}
        self._smoother.update(graph, values, stamps)
        self._smoother.update()
        smoother = self._smoother
        self._nav = gtsam.NavState(
            smoother.calculateEstimatePose3(X(n)), smoother.calculateEstimateVector(V(n))
        )
        self._bias = smoother.calculateEstimateConstantBias(B(n))
        self._covariance = smoother.marginalCovariance(X(n))
        self._ahead = self._integrated(fix.stamp_s, np.inf)

    def _begin(
        self, at_s: float, p_map: Float, graph: gtsam.NonlinearFactorGraph, values: gtsam.Values
    ) -> None:
        x, y, z = np.mean([sample.specific_force_m_s2 for sample in self._samples], axis=0)
        level = gtsam.Rot3.Ypr(0.0, np.arctan2(-x, np.hypot(y, z)), np.arctan2(y, z))
        R = level.matrix()
        P = np.zeros((6, 6))
        P[:3, :3] = R.T @ np.diag([_TILT_STD, _TILT_STD, _HEADING_STD]) ** 2 @ R
        P[3:, 3:] = 1e4 * np.eye(3)
        T = gtsam.Pose3(level, p_map)
        diagonal = gtsam.noiseModel.Diagonal.Sigmas
        graph.add(gtsam.PriorFactorPose3(X(0), T, gtsam.noiseModel.Gaussian.Covariance(P)))
        graph.add(gtsam.PriorFactorVector(V(0), np.zeros(3), diagonal(_VELOCITY_STD * np.ones(3))))
        graph.add(gtsam.PriorFactorConstantBias(B(0), self._bias, diagonal(self._bias_std)))
        values.insert(X(0), T)
        values.insert(V(0), np.zeros(3))
        values.insert(B(0), self._bias)
        self._number, self._at_s = 0, at_s
        self._samples = deque(sample for sample in self._samples if sample.stamp_s > at_s - 0.1)

    def _step(self, at_s: float, graph: gtsam.NonlinearFactorGraph, values: gtsam.Values) -> None:
        """Add a state at a time; a second antenna's fix at the same time needs none."""
        between = self._integrated(self._at_s, at_s)
        if between.deltaTij() < 1e-4:
            return
        n = self._number + 1
        graph.add(gtsam.CombinedImuFactor(X(n - 1), V(n - 1), X(n), V(n), B(n - 1), B(n), between))
        predicted = between.predict(self._nav, self._bias)
        values.insert(X(n), predicted.pose())
        values.insert(V(n), predicted.velocity())
        values.insert(B(n), self._bias)
        self._number, self._at_s = n, at_s
        while len(self._samples) > 1 and self._samples[0].stamp_s <= at_s:
            self._samples.popleft()

    def _integrated(self, from_s: float, to_s: float) -> gtsam.PreintegratedCombinedMeasurements:
        """Return the samples between two times; each holds from the one before it to its stamp."""
        answer = gtsam.PreintegratedCombinedMeasurements(self._params, self._bias)
        last_s = from_s
        for sample in self._samples:
            if sample.stamp_s > last_s:
                end_s = min(sample.stamp_s, to_s)
                _integrate(answer, sample, end_s - last_s)
                last_s = end_s
            if sample.stamp_s >= to_s:
                break
        return answer

    def add_odometry(self, increment: LidarIncrement) -> None:
        """Do nothing."""

    def add_joints(self, sample: JointSample) -> None:
        """Do nothing."""

    def state(self) -> BaseState:
        T, v, P = np.eye(4), np.zeros(3), np.eye(6)
        if self._nav is not None:
            nav = self._ahead.predict(self._nav, self._bias)
            T, v, P = nav.pose().matrix(), nav.velocity(), self._covariance
        newest = self._samples[-1]
        status = "GLOBAL" if self._number > 0 else "INITIALISING"
        return BaseState(newest.stamp_s, T, T, T, v, newest.angular_velocity_rad_s, P, status)


def _integrate(
    between: gtsam.PreintegratedCombinedMeasurements, sample: ImuSample, dt_s: float
) -> None:
    if dt_s > 0:
        between.integrateMeasurement(
            sample.specific_force_m_s2, sample.angular_velocity_rad_s, dt_s
        )
