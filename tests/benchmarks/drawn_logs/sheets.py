"""Data sheets of drawn sensors, and how far they are from the truth."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Float


@dataclass(frozen=True, slots=True, eq=False)
class ImuSheet:
    """An inertial sensor: standard deviation of a sample, and constant biases.

    Attributes:
        rate_hz: Samples a second.
        gyro_std: [rad/s].
        accel_std: [m/s²].
        gyro_bias: [rad/s], shape (3,).
        accel_bias: [m/s²], shape (3,).
        gyro_walk: Random walk of the bias [rad/s/√s].
        accel_walk: Random walk of the bias [m/s²/√s].
    """

    rate_hz: float
    gyro_std: float
    accel_std: float
    gyro_bias: Float
    accel_bias: Float
    gyro_walk: float
    accel_walk: float

    @classmethod
    def draw(cls, rng: np.random.Generator) -> "ImuSheet":
        """Draw a sensor between a tactical-grade one and a cheap one on a body that shakes."""
        rate_hz = float(
            rng.choice([50, 100, 125, 200, 250, 400, 1000], p=[0.1, 0.25, 0.1, 0.3, 0.1, 0.1, 0.05])
        )
        root = np.sqrt(rate_hz)
        return cls(
            rate_hz,
            root * _log_uniform(rng, 1e-4, 3e-3),
            root * _log_uniform(rng, 1e-3, 3e-2),
            _direction(rng) * _log_uniform(rng, 1e-3, 0.2),
            _direction(rng) * _log_uniform(rng, 0.01, 0.5),
            _log_uniform(rng, 1e-6, 1e-4),
            _log_uniform(rng, 1e-5, 1e-3),
        )


@dataclass(frozen=True, slots=True, eq=False)
class GnssSheet:
    """A satellite receiver.

    Attributes:
        rate_hz: Fixes a second.
        horizontal_m: Declared standard deviation east and north [m].
        vertical_m: The same up [m].
        truth: True standard deviation over the declared one.
        is_rtk_fixed: Whether it says that ambiguities are fixed.
        latency_s: From measurement to arrival [s].
        offset_s: Error of its stamps [s]; positive stamps are late.
        antennas: Positions on the body [m], shape (A, 3).
    """

    rate_hz: float
    horizontal_m: float
    vertical_m: float
    truth: float
    is_rtk_fixed: bool
    latency_s: float
    offset_s: float
    antennas: Float

    @classmethod
    def draw(cls, rng: np.random.Generator) -> "GnssSheet":
        """Draw a receiver: RTK in two of three, with one antenna or two."""
        is_rtk = bool(rng.random() < 0.67)
        horizontal_m = _log_uniform(rng, 0.005, 0.03) if is_rtk else _log_uniform(rng, 0.2, 3.0)
        first = rng.uniform([-1.0, -1.0, 0.0], [1.0, 1.0, 2.0])
        antennas = [first]
        if rng.random() < 0.4:
            antennas.append(first + [*(_direction(rng)[:2] * rng.uniform(0.5, 2.0)), 0.0])
        return cls(
            float(rng.choice([1, 4, 5, 10, 20, 50])),
            horizontal_m,
            horizontal_m * rng.uniform(1.0, 2.5),
            _log_uniform(rng, 0.3, 5.0) if rng.random() < 0.3 else 1.0,
            is_rtk,
            rng.uniform(0.0, 0.15),
            rng.uniform(-0.2, 0.2) if rng.random() < 0.2 else 0.0,
            np.array(antennas),
        )


@dataclass(frozen=True, slots=True)
class OdometrySheet:
    """Odometry by lidar or cameras: increments of the pose that drift.

    Attributes:
        rate_hz: Increments a second.
        drift: Error of an increment's length, as a share of it, and its constant part.
        turn_rad_m: Turning per metre [rad/m].
        step_m: White noise of an increment [m]; declared truly.
        step_rad: White noise of an increment [rad]; declared truly.
    """

    rate_hz: float
    drift: float
    turn_rad_m: float
    step_m: float
    step_rad: float

    @classmethod
    def draw(cls, rng: np.random.Generator) -> "OdometrySheet":
        """Draw odometry with a drift of 0.1 to 3 %."""
        drift = _log_uniform(rng, 0.001, 0.03)
        return cls(
            float(rng.choice([5, 10, 20])),
            drift * rng.choice([-1.0, 1.0]),
            rng.normal(0.0, 0.1 * drift),
            _log_uniform(rng, 0.001, 0.02),
            _log_uniform(rng, 0.0002, 0.003),
        )


def _log_uniform(rng: np.random.Generator, lowest: float, highest: float) -> float:
    return float(np.exp(rng.uniform(np.log(lowest), np.log(highest))))


def _direction(rng: np.random.Generator) -> Float:
    v = rng.normal(size=3)
    return np.asarray(v / np.linalg.norm(v))
