"""The first state with one antenna: level at rest, heading from the first metres of motion."""

from collections import deque

import numpy as np
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    ACCEL_BIAS,
    POSITION,
    ROTATION,
    VELOCITY,
    Inertial,
    InertialState,
    propagate,
)
from executive_plugins.estimation.start.settings import MovingStartSettings

from executive.arrays import Float
from executive.geometry.rotation import from_rpy


class MovingStart:
    """Dead-reckons from rest with an unknown heading, and fits that path to the path of the fixes.

    The inertial path is correct up to one rotation about the vertical, since gravity has levelled
    it. The rotation that fits best is the heading. The direction of motion does not matter: the
    body may move sideways or backwards.
    """

    def __init__(
        self, settings: MovingStartSettings, antenna_imu: Float, noise: InertialNoise
    ) -> None:
        self._settings = settings
        self._antenna_imu = antenna_imu
        self._noise = noise
        self._state: InertialState | None = None

    def begin(self, state: InertialState, covariance: Float) -> None:
        """Restart from a state at rest with an arbitrary heading.

        The fixes that follow are compared with the antenna's position at rest.
        """
        self._state, self._covariance = state, covariance
        self._rest_s = state.stamp_s
        self._origin = state.p_map_imu + state.R_map_imu @ self._antenna_imu
        self._path: deque[tuple[float, Float]] = deque()
        self._fixes: deque[tuple[float, Float]] = deque()

    def add_sample(self, sample: Inertial) -> None:
        """Dead-reckon by a sample; stop after `duration_s` without a result."""
        if self._state is None:
            return
        if sample.stamp_s - self._rest_s > self._settings.duration_s:
            self._state = None
            return
        self._state = propagate(self._state, sample, self._noise.gravity_m_s2)
        self._path.append(
            (sample.stamp_s, self._state.p_map_imu + self._state.R_map_imu @ self._antenna_imu)
        )

    def add_fix(self, stamp_s: float, p_map_antenna: Float) -> None:
        """Add the measured position of the antenna in the map [m], shape (3,)."""
        if self._state is not None and stamp_s > self._rest_s:
            self._fixes.append((stamp_s, p_map_antenna))

    def state(self) -> tuple[InertialState, Float] | None:
        """Return the state at the newest sample and its error's covariance (15, 15).

        None while the path is too short or the two paths do not fit.
        """
        if self._state is None or not self._is_far():
            return None
        elapsed_s, measured, reckoned = self._paths()
        (cosine, sine), velocity, misfit_m = _fit(elapsed_s, measured, reckoned)
        misfit = misfit_m / float(np.linalg.norm(measured[-1]))
        if max(misfit, abs(np.hypot(cosine, sine) - 1)) > self._settings.max_misfit:
            if np.linalg.norm(measured[-1]) > 3 * self._settings.distance_m:
                self._state = (
                    None  # a longer path would not improve the fit: wait for the next rest
                )
            return None
        R = from_rpy(0.0, 0.0, float(np.arctan2(sine, cosine)))
        return self._turned(R, velocity), self._widened(misfit)

    def _is_far(self) -> bool:
        if len(self._fixes) < 8 or not self._path or self._path[-1][0] < self._fixes[-1][0]:
            return False
        return bool(np.linalg.norm(self._fixes[-1][1] - self._origin) > self._settings.distance_m)

    def _paths(self) -> tuple[Float, Float, Float]:
        """Return the fixes and the dead-reckoned path, relative to the position at rest.

        Returns:
            Times since rest [s], shape (n,); positions of the fixes and of the dead reckoning at
            these times [m], shape (n, 3) each.
        """
        stamps = np.array([stamp_s for stamp_s, _ in self._fixes])
        path_s, path = (
            np.array([s for s, _ in self._path]),
            np.array([p for _, p in self._path]) - self._origin,
        )
        reckoned = np.column_stack([np.interp(stamps, path_s, path[:, i]) for i in range(3)])
        return stamps - self._rest_s, np.array([p for _, p in self._fixes]) - self._origin, reckoned

    def _turned(self, R: Float, velocity: Float) -> InertialState:
        """Rotate the dead-reckoned state about the rest position, and end it at the last fix."""
        state = self._state
        if state is None:
            raise RuntimeError("the moving start has not begun")
        v = R @ state.v_map_imu + velocity
        fix_s, p_fix = self._fixes[-1]
        p = p_fix + (state.stamp_s - fix_s) * v - R @ state.R_map_imu @ self._antenna_imu
        return InertialState(
            state.sample, R @ state.R_map_imu, p, v, state.gyro_bias, state.accel_bias
        )

    def _widened(self, misfit: float) -> Float:
        """Widen the covariance at rest by the misfit of the two paths."""
        P = self._covariance.copy()
        R_imu_map = self._state.R_map_imu.T if self._state is not None else np.eye(3)
        level = float(np.sqrt(np.linalg.eigvalsh(P[ROTATION, ROTATION])[0])) + 0.01
        heading = misfit + 0.02
        P[ROTATION, ROTATION] = R_imu_map @ np.diag([level**2, level**2, heading**2]) @ R_imu_map.T
        # Dead reckoning has weakened the correlation of bias and tilt that held at rest.
        P[ROTATION, ACCEL_BIAS] = P[ACCEL_BIAS, ROTATION] = 0.0
        P[VELOCITY, VELOCITY] = 0.5**2 * np.eye(3)
        P[POSITION, POSITION] = 0.1**2 * np.eye(3)
        return P


def _fit(elapsed_s: Float, measured: Float, reckoned: Float) -> tuple[Float, Float, float]:
    """Fit measured = turn · reckoned + v t + constant in the horizontal, by linear least squares.

    The velocity v is part of the model because rest ends some tenths of a second before the end is
    detected.

    Returns:
        (cosine, sine) of the turn, not normalised, where a length of 1 indicates a good fit;
        v [m/s], shape (3,), horizontal; largest misfit [m].
    """
    n = len(elapsed_s)
    (x, y), one, none = reckoned[:, :2].T, np.ones(n), np.zeros(n)
    east = np.column_stack([x, -y, elapsed_s, none, one, none])
    north = np.column_stack([y, x, none, elapsed_s, none, one])
    A, b = np.vstack([east, north]), measured[:, :2].T.ravel()
    solution = np.linalg.lstsq(A, b, rcond=None)[0]
    return solution[:2], np.append(solution[2:4], 0.0), float(np.abs(A @ solution - b).max())
