"""The first state of the filter, from a few seconds at rest (Nubert 2022, Sec. IV-A5)."""

from collections import deque
from collections.abc import Mapping

import numpy as np
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import (
    ACCEL_BIAS,
    DIMENSION,
    GYRO_BIAS,
    POSITION,
    ROTATION,
    VELOCITY,
    Inertial,
    InertialState,
)
from executive_plugins.estimation.start.chassis_level import ChassisLevel
from executive_plugins.estimation.start.settings import RestSettings

from executive.arrays import Float
from executive.geometry.rotation import skew

# A spread of the fixes below this multiple of their stated standard deviation is noise, not motion.
_DECLARED = 2.0
# Two level sensors that differ by more standard deviations than this are not mounted as described.
_MOUNTING_SIGMAS = 4.0


class RestInitialisation:
    """Finds a first state once the machine was at rest over the newest few seconds.

    Attributes:
        waits_for: Why the last call of `state` gave no state; empty if it gave one, or if there
            were too few samples to tell.
        moves: Whether that was because the machine moves.
    """

    def __init__(
        self,
        settings: RestSettings,
        antennas_imu: Mapping[str, Float],
        noise: InertialNoise,
        chassis: ChassisLevel | None = None,
    ) -> None:
        self._settings = settings
        self._chassis = chassis
        self._antennas_imu = antennas_imu
        self._noise = noise
        self._samples: deque[Inertial] = deque()
        self._fixes: dict[str, deque[tuple[float, Float]]] = {
            name: deque() for name in antennas_imu
        }
        self._fix_std_m = 0.0  # of the newest fix
        self.waits_for, self.moves = "", False

    def add_sample(self, sample: Inertial) -> None:
        """Add one inertial sample."""
        self._samples.append(sample)
        while self._samples[0].stamp_s < sample.stamp_s - self._settings.duration_s - 1e-6:
            self._samples.popleft()

    def add_fix(self, stamp_s: float, antenna: str, p_map_antenna: Float, std_m: float) -> None:
        """Add a fix.

        Args:
            stamp_s: Time of measurement [s].
            antenna: Name of the antenna.
            p_map_antenna: Its measured position in the map [m], shape (3,).
            std_m: Largest standard deviation of the position [m].
        """
        fixes = self._fixes[antenna]
        self._fix_std_m = std_m
        fixes.append((stamp_s, p_map_antenna))
        while fixes[0][0] < stamp_s - self._settings.duration_s - 1e-6:
            fixes.popleft()

    def state(self) -> tuple[InertialState, Float] | None:
        """Return the state at the newest sample and its error's covariance (15, 15).

        None if the machine moves, or if there are too few samples.
        """
        self.moves = False
        if not self._samples or not self._is_long_enough():
            return None
        rates = np.array([s.rate for s in self._samples])
        forces = np.array([s.force for s in self._samples])
        positions = {name: np.array([p for _, p in fixes]) for name, fixes in self._fixes.items()}
        self.waits_for = self._motion(rates, forces, positions)
        self.moves = bool(self.waits_for)
        if self.moves:
            return None
        means = {name: p.mean(axis=0) for name, p in positions.items()}
        force = forces.mean(axis=0)
        up_imu, level_rad = self._level(force)
        R = self._attitude(up_imu, means)
        position = np.mean([p - R @ self._antennas_imu[name] for name, p in means.items()], axis=0)
        # Perpendicular to gravity, bias and tilt cannot be told apart: the rest is taken as bias.
        accel_bias = force - self._noise.gravity_m_s2 * up_imu
        state = InertialState(
            self._samples[-1], R, position, np.zeros(3), rates.mean(axis=0), accel_bias
        )
        return state, self._covariance(R, level_rad, rates, positions)

    def unrest_rad_s(self) -> float:
        """Return how fast a body turns that seems to be at rest, by two halves of the time.

        A body that begins to move, or rocks on tyres or soil, shows it in how the means of angular
        velocity and of the direction of gravity differ.
        """
        rates = np.array([s.rate for s in self._samples])
        forces = np.array([s.force for s in self._samples])
        half = len(rates) // 2
        half_s = self._samples[-1].stamp_s - self._samples[half].stamp_s
        turned = rates[half:].mean(axis=0) - rates[:half].mean(axis=0)
        tilted = forces[half:].mean(axis=0) - forces[:half].mean(axis=0)
        tilt_rad_s = np.linalg.norm(tilted) / (self._noise.gravity_m_s2 * half_s)
        return float(max(np.abs(turned).max(), tilt_rad_s))

    def _is_long_enough(self) -> bool:
        self.waits_for = ""
        start_s = self._samples[-1].stamp_s - 0.9 * self._settings.duration_s
        if self._samples[0].stamp_s > start_s or len(self._samples) < 20:
            return False
        few = [
            name for name, fixes in self._fixes.items() if len(fixes) < 5 or fixes[-1][0] <= start_s
        ]
        if few:
            self.waits_for = f"fixes of {' and '.join(few)}: fewer than five so far"
        return not few

    def _motion(self, rates: Float, forces: Float, positions: Mapping[str, Float]) -> str:
        """Return a sign of motion in words; empty if there is none."""
        settings = self._settings
        turn, shake, jolt = (
            np.linalg.norm(rates.mean(axis=0)),
            rates.std(axis=0).max(),
            forces.std(axis=0).max(),
        )
        if turn >= settings.max_rate_rad_s:
            return f"rest: it turns at {turn:.3f} rad/s"
        if shake >= settings.max_rate_std_rad_s:
            return f"rest: its rate varies by {shake:.3f} rad/s"
        if jolt >= settings.max_force_std_m_s2:
            return f"rest: its force varies by {jolt:.2f} m/s²"
        spread_m, name = max((float(p.std(axis=0).max()), name) for name, p in positions.items())
        if spread_m >= max(settings.max_antenna_std_m, _DECLARED * self._fix_std_m):
            return f"rest: the fixes of {name} vary by {spread_m:.3f} m"
        return ""

    def _level(self, force: Float) -> tuple[Float, float]:
        """Return the upward direction in IMU axes, and its standard deviation [rad].

        The accelerometers of cabin and chassis have independent errors, so that their weighted
        mean is more accurate than either.
        """
        cabin_rad = self._noise.accel_bias_m_s2 / self._noise.gravity_m_s2
        up_imu = force / np.linalg.norm(force)
        other = (
            self._chassis.up_imu(self._samples[-1].stamp_s) if self._chassis is not None else None
        )
        if self._chassis is None or other is None:
            return up_imu, cabin_rad
        chassis_rad = self._chassis.accel_bias_m_s2 / self._noise.gravity_m_s2
        if np.linalg.norm(other - up_imu) > _MOUNTING_SIGMAS * np.hypot(cabin_rad, chassis_rad):
            return up_imu, cabin_rad
        mean = up_imu / cabin_rad**2 + other / chassis_rad**2
        return mean / np.linalg.norm(mean), (cabin_rad**-2 + chassis_rad**-2) ** -0.5

    def _attitude(self, up_imu: Float, means: Mapping[str, Float]) -> Float:
        """Level by gravity, then find the heading from the baseline of two antennas.

        This is TRIAD with gravity first. With one antenna the heading cannot be observed at rest:
        an arbitrary axis across gravity is then assumed to point east.
        """
        up = np.array([0.0, 0.0, 1.0])
        if len(means) == 1:
            return (
                _triad(up, np.array([1.0, 0.0, 0.0]))
                @ _triad(up_imu, np.eye(3)[np.argmin(np.abs(up_imu))]).T
            )
        first, second = tuple(means)[:2]
        baseline_map = means[second] - means[first]
        baseline_imu = self._antennas_imu[second] - self._antennas_imu[first]
        return _triad(up, baseline_map) @ _triad(up_imu, baseline_imu).T

    def _covariance(
        self, R: Float, level_rad: float, rates: Float, positions: Mapping[str, Float]
    ) -> Float:
        noise = self._noise
        arms = tuple(self._antennas_imu[name] for name in positions)[:2]
        spread_m = max(p.std(axis=0).max() for p in positions.values())
        # Twice the standard error of a mean, for the errors of neighbouring fixes are correlated.
        fix_m = 2 * max(p.std(axis=0).max() / np.sqrt(len(p)) for p in positions.values())
        # From the error of the fixes and the length of the baseline; one antenna has no baseline.
        heading = (
            np.sqrt(2) * fix_m / np.linalg.norm(arms[1] - arms[0]) if len(arms) == 2 else np.pi
        )
        std = np.zeros(DIMENSION)
        std[VELOCITY] = max(0.01, spread_m / self._settings.duration_s)
        std[POSITION] = fix_m + level_rad * np.linalg.norm(arms[0])
        std[GYRO_BIAS] = max(3 * float(rates.std()) / np.sqrt(len(rates)), 1e-5)
        P = np.diag(std**2)
        P[ROTATION, ROTATION] = R.T @ np.diag([level_rad**2, level_rad**2, heading**2]) @ R
        _tie_bias_to_tilt(P, R, noise, noise.accel_density / np.sqrt(self._settings.duration_s))
        return P


def _tie_bias_to_tilt(P: Float, R: Float, noise: InertialNoise, mean_std_m_s2: float) -> None:
    """Enter the variance of the accelerometer bias b and its correlation with the tilt θ, in place.

    At rest f = Rᵀ g + b was measured, so that δb = −[Rᵀ g]× δθ. If bias and tilt were entered as
    independent, their variances would fall too low by a factor of two once the velocity is
    observed, and the bias would be learnt at half the pace. `mean_std_m_s2` is the standard
    deviation of f.
    """
    up_imu = R.T @ np.array([0.0, 0.0, 1.0])
    J = -skew(noise.gravity_m_s2 * up_imu)
    tilt = P[ROTATION, ROTATION]
    along = noise.accel_bias_m_s2**2 * np.outer(up_imu, up_imu)
    P[ACCEL_BIAS, ACCEL_BIAS] = J @ tilt @ J.T + along + mean_std_m_s2**2 * np.eye(3)
    P[ACCEL_BIAS, ROTATION] = J @ tilt
    P[ROTATION, ACCEL_BIAS] = (J @ tilt).T


def _triad(first: Float, second: Float) -> Float:
    """Return the orthonormal frame with z along the first vector, shape (3, 3).

    Its x axis is along the component of the second vector that is perpendicular to the first.
    """
    z = first / np.linalg.norm(first)
    x = second - (second @ z) * z
    x = x / np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])
