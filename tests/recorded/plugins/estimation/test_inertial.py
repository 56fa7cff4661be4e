"""The strapdown state, its covariance and its measurements, of one state in general position."""

import numpy as np
import pytest
from executive_plugins.estimation.filters.cloning_filter import CloningFilter
from executive_plugins.estimation.inertial.measurement_models import (
    antenna_residual,
    standstill_residual,
)
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import (
    Inertial,
    InertialState,
    carry_covariance,
    error_transition,
    propagate,
    propagate_through,
    retract,
    rotation_step,
    stepped,
)
from executive_plugins.estimation.kalman.compiled_correction import correct_into
from executive_plugins.estimation.kalman.error_state_filter import ErrorStateFilter

from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy

NOISE = InertialNoise(0.01, 0.05, 0.002, 0.003, 0.02, 9.81, 0.01)


def sample(stamp_s: float, since_last_s: float = 0.01) -> Inertial:
    rng = np.random.default_rng(round(1000 * stamp_s))
    return Inertial(stamp_s, rng.normal(0, 0.4, 3), rng.normal(0, 2, 3), since_last_s)


def state() -> InertialState:
    rng = np.random.default_rng(1)
    p, v, gyro, accel = rng.normal(0, 1, (4, 3))
    return InertialState(sample(1.0), from_rpy(0.3, -0.2, 2.0), p, v, 0.01 * gyro, 0.1 * accel)


def covariance(size: int = 15) -> np.ndarray:
    A = np.random.default_rng(2).normal(0, 0.1, (size, size))
    return A @ A.T + 0.01 * np.eye(size)


def test_propagation(recorded) -> None:
    later = [sample(1.01), sample(1.03), sample(1.5)]
    recorded((propagate(state(), later[2], 9.81), propagate_through(state(), later, 9.8)))


@pytest.mark.parametrize("dt_s", [0.01, 0.5])
def test_covariance(recorded, dt_s) -> None:
    cross = np.random.default_rng(3).normal(0, 1, (15, 6))
    after, carried, crossed = stepped(state(), covariance(), cross, sample(1.0 + dt_s), NOISE)
    same = carry_covariance(state(), covariance(), NOISE, dt_s)
    np.testing.assert_allclose(carried, same, rtol=1e-13)
    moved = propagate(state(), sample(1.0 + dt_s), 9.81)
    np.testing.assert_allclose(after.p_map_imu, moved.p_map_imu, rtol=1e-13)
    recorded((carried, crossed, error_transition(state(), dt_s)))


def test_retraction(recorded) -> None:
    recorded(retract(state(), np.random.default_rng(4).normal(0, 0.2, 15)))


@pytest.mark.parametrize("scale", [0.0, 1e-6, 4e-6, 6e-6, 1e-3, 1.0, 4.0])
def test_rotation_step(recorded, scale) -> None:
    """The matrix minus one, so that the small terms of a small turn count."""
    recorded((rotation_step(scale * np.array([1.0, -2.0, 0.5])) - np.eye(3)) / (scale or 1.0))


def test_measurement_models(recorded) -> None:
    arm, p = np.array([0.3, -1.0, 0.7]), np.array([1.0, 2.0, 3.0])
    recorded(
        (
            antenna_residual(state(), arm, p),
            standstill_residual(state(), arm),
        )
    )


def test_noise_of_a_data_sheet(recorded, machine) -> None:
    sheet = machine.sensors["imu_cabin"]
    noises = [name for name in type(sheet).model_fields if name.startswith(("gyro", "accel"))]
    good = sheet.model_copy(update={name: 0.1 * (k + 1) for k, name in enumerate(noises)})
    ideal = sheet.model_copy(update=dict.fromkeys(noises, 0.0))
    recorded([InertialNoise.of(one, 3.0, 9.8) for one in (sheet, good, ideal)])


def test_samples_between_any_two_times(recorded) -> None:
    buffer, told = SampleBuffer(), []
    for k in range(5):
        buffer.append(sample(k / 4))
    times = [0.0, 0.1, 0.25, 0.3, 0.75, 1.0, 1.25]
    for begin in times:
        told.append((begin, buffer.at(begin), buffer.ends_at(begin)))
        told += [[one.stamp_s for one in buffer.between(begin, end)] for end in times]
    buffer.forget_before(0.5)
    told.append((buffer.newest_s, buffer.ends_at(0.25), buffer.ends_at(0.5), buffer.at(0.0)))
    recorded(told)


def corrected(P, H, residual, noise, gate):
    (m, n), error = H.shape, np.empty(H.shape[1])
    W, L, after = np.empty((m, n + 1)), np.empty((m, m)), np.empty((n, n))
    distance2 = correct_into(P, H, residual, noise, gate, W, L, after, error)
    return (after, error) if distance2 <= gate else None


def test_corrections(recorded) -> None:
    rng = np.random.default_rng(5)
    P, H, residual, noise = covariance(), rng.normal(0, 1, (3, 15)), rng.normal(0, 1, 3), np.eye(3)
    H[0, :4] = 0.0
    skewed = P + np.triu(1e-3 * rng.normal(0, 1, (15, 15)), 1)
    recorded(
        [
            corrected(P, H, residual, noise, 1e6),
            corrected(skewed, H, residual, noise, 1e6),
            corrected(P, H, residual, noise, 1e-3),
            corrected(P, H, residual, -1e6 * noise, 1e6),
            corrected(P, H, residual, noise * np.nan, 1e6),
            corrected(P, np.zeros((1, 15)), np.array([2.0]), np.eye(1), 4.0),  # at the gate
            corrected(P, np.zeros((1, 15)), np.array([2.0]), np.zeros((1, 1)), 4.0),
        ]
    )


@pytest.mark.parametrize("since_last_s", [0.05, 0.1, 0.2])
def test_an_error_state_filter(recorded, since_last_s) -> None:
    kalman = ErrorStateFilter(state(), covariance(), NOISE)
    kalman.predict(sample(1.0))
    kalman.predict(sample(0.5))
    kalman.predict(sample(1.05, since_last_s))
    used = kalman.correct(np.ones(3), np.eye(3, 15), 0.1 * np.eye(3), 100.0)
    kalman.inflate(0.1, 0.2, 0.3)
    recorded((used, kalman.state, kalman.covariance))


def test_a_cloning_filter(recorded) -> None:
    kalman = CloningFilter(state(), covariance(), NOISE)
    told: list[object] = [kalman.has_clone_at(1.0)]
    told.append(kalman.correct(np.ones(3), np.eye(3, 15), np.eye(3), 100.0))
    kalman.predict(sample(1.1))
    kalman.clone()
    told += [kalman.has_clone_at(t) for t in (1.1, 1.1 + 0.9e-6, 1.1 + 1.9e-6)]
    kalman.predict(sample(1.1))
    kalman.predict(sample(1.2))
    told.append(kalman.correct(np.ones(3), np.eye(3, 15), np.eye(3), 100.0))
    motion = pose(from_rpy(0.01, 0.02, 0.1), np.array([0.1, 0.2, -0.1]))
    told.append(kalman.correct_by_increment(kalman.increment(motion, covariance(6)), 1e3))
    told.append((kalman.state, kalman.covariance))
    told.append(kalman.correct_by_increment(kalman.increment(motion, covariance(6)), 1e-9))
    kalman.clone()
    kalman.predict(sample(1.3))
    told.append(kalman.correct_by_increment(kalman.increment(motion, covariance(6)), 1e3))
    recorded((told, kalman.state, kalman.covariance))
