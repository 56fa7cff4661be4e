"""The first state of the filter, from a few seconds at rest (Nubert 2022, Sec. IV-A5)."""

from collections import deque
from collections.abc import Mapping

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import RadiansPerSecond, Seconds, Settings
from plugins.estimation.inertial_noise import InertialNoise
from plugins.estimation.inertial_state import (
    ACCEL_BIAS,
    DIMENSION,
    GYRO_BIAS,
    POSITION,
    ROTATION,
    VELOCITY,
    Inertial,
    InertialState,
)


class RestSettings(Settings):
    """What counts as rest."""

    duration_s: Seconds = Field(2.0, gt=0, le=60, description="Rest that is needed before the first state [s].")
    max_rate_rad_s: RadiansPerSecond = Field(
        0.02, gt=0, le=0.2, description="Fastest mean turn that may be a bias [rad/s]."
    )
    max_rate_std_rad_s: RadiansPerSecond = Field(
        0.02, gt=0, le=0.2, description="Largest spread of the angular velocity [rad/s]."
    )
    max_force_std_m_s2: float = Field(0.3, gt=0, le=5, description="Largest spread of the specific force [m/s²].")
    max_antenna_std_m: float = Field(0.06, gt=0, le=1, description="Largest spread of an antenna's fixes [m].")


class RestInitialisation:
    """Collects samples, forgets old ones, and gives a state as soon as the newest few seconds were at rest."""

    def __init__(self, settings: RestSettings, antennas_imu: Mapping[str, Float], noise: InertialNoise) -> None:
        self._settings = settings
        self._antennas_imu = antennas_imu
        self._noise = noise
        self._samples: deque[Inertial] = deque()
        self._fixes: dict[str, deque[tuple[float, Float]]] = {name: deque() for name in antennas_imu}

    def add_sample(self, sample: Inertial) -> None:
        """Take one inertial sample."""
        self._samples.append(sample)
        while self._samples[0].stamp_s < sample.stamp_s - self._settings.duration_s - 1e-6:
            self._samples.popleft()

    def add_fix(self, stamp_s: float, antenna: str, p_map_antenna: Float) -> None:
        """Take the measured position of an antenna in the map."""
        fixes = self._fixes[antenna]
        fixes.append((stamp_s, p_map_antenna))
        while fixes[0][0] < stamp_s - self._settings.duration_s - 1e-6:
            fixes.popleft()

    def state(self) -> tuple[InertialState, Float] | None:
        """Return the state at the newest sample and its error's covariance (15, 15), or None: moving, or not yet."""
        if not self._samples or not self._is_long_enough():
            return None
        rates = np.array([s.rate for s in self._samples])
        forces = np.array([s.force for s in self._samples])
        positions = {name: np.array([p for _, p in fixes]) for name, fixes in self._fixes.items()}
        if not self._is_at_rest(rates, forces, positions):
            return None
        means = {name: p.mean(axis=0) for name, p in positions.items()}
        force = forces.mean(axis=0)
        R = self._attitude(force, means)
        position = np.mean([p - R @ self._antennas_imu[name] for name, p in means.items()], axis=0)
        # At rest the length of the force is gravity's; across it, bias and tilt look the same.
        accel_bias = force * (1 - self._noise.gravity_m_s2 / np.linalg.norm(force))
        state = InertialState(self._samples[-1], R, position, np.zeros(3), rates.mean(axis=0), accel_bias)
        return state, self._covariance(R, rates, positions)

    def _is_long_enough(self) -> bool:
        start_s = self._samples[-1].stamp_s - 0.9 * self._settings.duration_s
        if self._samples[0].stamp_s > start_s or len(self._samples) < 20:
            return False
        return all(len(fixes) >= 5 and fixes[-1][0] > start_s for fixes in self._fixes.values())

    def _is_at_rest(self, rates: Float, forces: Float, positions: Mapping[str, Float]) -> bool:
        settings = self._settings
        return bool(
            np.linalg.norm(rates.mean(axis=0)) < settings.max_rate_rad_s
            and rates.std(axis=0).max() < settings.max_rate_std_rad_s
            and forces.std(axis=0).max() < settings.max_force_std_m_s2
            and all(p.std(axis=0).max() < settings.max_antenna_std_m for p in positions.values())
        )

    def _attitude(self, force: Float, means: Mapping[str, Float]) -> Float:
        """Level by gravity, then turn by the baseline of the two antennas (TRIAD, gravity first).

        One antenna tells no heading at rest: any axis across gravity is then taken to look east.
        """
        up = np.array([0.0, 0.0, 1.0])
        if len(means) == 1:
            return _triad(up, np.array([1.0, 0.0, 0.0])) @ _triad(force, np.eye(3)[np.argmin(np.abs(force))]).T
        first, second = tuple(means)[:2]
        baseline_map = means[second] - means[first]
        baseline_imu = self._antennas_imu[second] - self._antennas_imu[first]
        return _triad(up, baseline_map) @ _triad(force, baseline_imu).T

    def _covariance(self, R: Float, rates: Float, positions: Mapping[str, Float]) -> Float:
        noise = self._noise
        arms = tuple(self._antennas_imu[name] for name in positions)[:2]
        # Twice the standard error of a mean, for neighbouring fixes err alike.
        fix_m = 2 * max(p.std(axis=0).max() / np.sqrt(len(p)) for p in positions.values())
        level = noise.accel_bias_m_s2 / noise.gravity_m_s2  # as good as the accelerometer's bias
        # As good as the fixes over their baseline; one antenna has none.
        heading = np.sqrt(2) * fix_m / np.linalg.norm(arms[1] - arms[0]) if len(arms) == 2 else np.pi
        std = np.zeros(DIMENSION)
        std[VELOCITY] = 0.01
        std[POSITION] = fix_m + level * np.linalg.norm(arms[0])
        std[GYRO_BIAS] = max(3 * float(rates.std()) / np.sqrt(len(rates)), 1e-5)
        std[ACCEL_BIAS] = noise.accel_bias_m_s2
        P = np.diag(std**2)
        P[ROTATION, ROTATION] = R.T @ np.diag([level**2, level**2, heading**2]) @ R
        return P


def _triad(first: Float, second: Float) -> Float:
    """Return the orthonormal frame with z along the first vector and x along the second's part across it, (3, 3)."""
    z = first / np.linalg.norm(first)
    x = second - (second @ z) * z
    x = x / np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])
