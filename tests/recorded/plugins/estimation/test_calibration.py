"""Calibration of a body that swings and nods, with late receivers and odometry turned on it."""

from itertools import pairwise

import numpy as np
import pytest
from executive_plugins.estimation.calibration.first_guess import FirstGuess
from executive_plugins.estimation.calibration.keyframe_batch import KeyframeBatch, _clocks
from executive_plugins.estimation.calibration.motion_track import MotionTrack
from executive_plugins.estimation.calibration.odometry_fit import OdometryProblem
from executive_plugins.estimation.calibration.sample_noise import white_noise
from executive_plugins.estimation.calibration.settings import KeyframeBatchSettings
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import (
    Inertial,
    InertialState,
    propagate_through,
)
from executive_plugins.estimation.start.fix_groups import grouped, longest_straight_s
from scipy.spatial.transform import Rotation

from executive.errors import DataError
from executive.geometry.geodesy import geodetic_from_enu
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import from_rpy
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement

GRAVITY = 9.81
DATUM = np.array([47.4, 8.5, 440.0])
DT_S = 0.02
# The solvers stop at tolerances of their own.
SOLVED = 1e-4


def turned(t: float) -> Rotation:
    angles = [1.2 * np.sin(0.5 * t), 0.2 * np.sin(0.9 * t), 0.2 * np.cos(1.3 * t)]
    return Rotation.from_euler("ZYX", angles)


def place(t: float) -> np.ndarray:
    return np.array([3 * np.sin(0.7 * t), 2 * np.cos(0.5 * t), 0.3 * np.sin(0.4 * t)])


def measured(k: int) -> tuple[np.ndarray, np.ndarray]:
    """Return mean rate and specific force over the step that ends at k DT."""
    middle, h = (k - 0.5) * DT_S, 1e-3
    rate = (turned((k - 1) * DT_S).inv() * turned(k * DT_S)).as_rotvec() / DT_S
    pull = (place(middle + h) - 2 * place(middle) + place(middle - h)) / h**2
    return rate, turned(middle).inv().apply(pull + [0, 0, GRAVITY])


@pytest.fixture(scope="module")
def samples() -> SampleBuffer:
    rng, found = np.random.default_rng(1), SampleBuffer()
    for k in range(1, 500):
        rate, force = measured(k)
        noisy = rate + rng.normal(0, 2e-3, 3), force + rng.normal(0, 0.02, 3)
        found.append(Inertial(k * DT_S, *noisy, DT_S))
    return found


@pytest.fixture(scope="module")
def track(samples) -> MotionTrack:
    h = 1e-4
    states = [
        InertialState(
            samples.at(t),
            turned(t).as_matrix(),
            place(t),
            (place(t + h) - place(t - h)) / (2 * h),
            np.zeros(3),
            np.zeros(3),
        )
        for t in np.arange(0.5, 9.9, 0.5)
    ]
    return MotionTrack(states, samples, GRAVITY)


def test_a_track(recorded, track, samples) -> None:
    R, p = track.at(np.array([-1.0, 0.5, 0.507, 1.0, 3.333, 9.5, 99.0]))
    recorded((track.span_s, R.as_matrix(), p))
    first = next(iter(samples))
    recorded((first, samples.at(0.015), samples.at(99.0), samples.between(0.1, 0.17)))


def increments(track, T: np.ndarray, late_s: float, scale: float = 1.0, noise: float = 1e-3):
    rng = np.random.default_rng(2)
    stamps = np.arange(0.2, 9.6, 0.15)
    for first, last in pairwise(stamps):
        R, p = track.at(np.array([first - late_s, last - late_s]))
        poses = [pose(R[i].as_matrix(), p[i]) @ T for i in (0, 1)]
        step = inverse(poses[0]) @ poses[1]
        step[:3, :3] = step[:3, :3] @ Rotation.from_rotvec(rng.normal(0, noise, 3)).as_matrix()
        step[:3, 3] = scale * step[:3, 3] + rng.normal(0, noise, 3)
        yield LidarIncrement(first, last, "lidar", step, noise**2 * np.eye(6))


def test_odometry(recorded, track) -> None:
    declared, told = pose(from_rpy(0.1, -0.2, 1.4), np.array([0.5, -0.3, 0.8])), []
    for rpy, arm, late_s, scale in (
        ((0, 0, 0), (0, 0, 0), 0.0, 1.0),
        ((0.05, -0.04, 0.1), (0.1, -0.1, 0.05), 0.06, 1.05),
    ):
        true = declared @ pose(from_rpy(*rpy), np.zeros(3))
        true[:3, 3] += arm
        own = list(increments(track, true, late_s, scale))
        problem = OdometryProblem(own, track, declared, (0.3, 0.3, 0.1))
        fit = problem.solved()
        assert fit is not None
        assert fit.late_s == pytest.approx(late_s, abs=0.01)
        assert fit.T_imu_sensor == pytest.approx(true, abs=0.03)
        told.append((problem.count, problem.is_enough, fit))
        told.append((problem._residuals(np.linspace(-0.1, 0.1, 11)), problem._turning_misfit(0.04)))
        told += [OdometryProblem(own[:n], track, declared, (1, 1, 0.0)).is_enough for n in (31, 32)]
    recorded(told, relative=SOLVED)


def test_noise(recorded) -> None:
    rng, told = np.random.default_rng(3), []
    smooth = np.sin(np.linspace(0, 9, 900))[:, None] * (1, 2, 3)
    for count, std in ((399, 0.1), (400, 0.1), (900, 0.05), (900, 0.0)):
        told.append(white_noise(smooth[:count] + std * rng.normal(size=(count, 3))))
    recorded(told)


def fix(stamp_s: float, antenna: str = "a", std_m: float = 0.02) -> Fix:
    p = np.array([stamp_s, stamp_s**2, 1.0])
    return Fix(stamp_s, antenna, np.zeros(3), p, np.diag([1.0, 1.0, 4.0]) * std_m**2)


def test_groups(recorded) -> None:
    """Fixes at even and uneven times, of one antenna or two, of which one misses some times."""
    told = []
    for count, most in ((3, 4), (4, 4), (12, 4), (61, 7), (200, 5), (50, 2)):
        for std_m, period_s in ((0.01, 0.05), (1.0, 0.2)):
            stamps = [round(k * period_s + 0.003 * (k % 3), 6) for k in range(count)]
            by_time = {
                t: [fix(t, std_m=std_m), *([fix(t, "b", std_m)] if k % 5 else [])]
                for k, t in enumerate(stamps)
            }
            told.append(grouped(by_time, most))
    recorded(told)
    recorded([longest_straight_s(fix(0.0, std_m=std_m)) for std_m in (0.01, 0.1, 2.0)])


def test_receivers_are_those_that_share_stamps(recorded) -> None:
    a = [fix(t, "a") for t in (0.0, 1.0, 2.0, 3.0)]
    told = []
    for shared in ((), (0.0,), (0.0, 1.0), (0.0, 1.0, 2.0)):
        b = [fix(t if t in shared else t + 0.5, "b") for t in (0.0, 1.0, 2.0, 3.0)]
        told.append(_clocks([*a, *b, *(fix(t + 0.5, "c") for t in (1.0, 2.0))]))
    recorded(told)


def recording(machine, late_s: float, shift_m: float):
    """Yield ten seconds of the cabin's sensor and of two antennas that sit on its link."""
    rng = np.random.default_rng(4)
    imu = machine.sensors["imu_cabin"]
    antennas = [one for one in machine.sensors_of("gnss") if one.link == imu.link]
    arms = [(inverse(imu.T_link_sensor) @ one.T_link_sensor)[:3, 3] for one in antennas]
    for k in range(1, 750):
        t, (rate, force) = k * DT_S, measured(k)
        noisy = rate + rng.normal(0, 2e-3, 3), force + rng.normal(0, 0.02, 3)
        yield ImuSample(t, "imu_cabin", *noisy)
        if k % 10:
            continue
        for one, arm in zip(antennas, arms, strict=True):
            p = place(t) + turned(t).apply(arm + shift_m) + rng.normal(0, 0.01, 3)
            geodetic = geodetic_from_enu(p, DATUM)
            yield GnssFix(t + late_s, one.name, geodetic, 1e-4 * np.eye(3), True)


@pytest.mark.parametrize(("late_s", "shift_m"), [(0.0, 0.0), (0.08, 0.1)])
def test_a_recording(recorded, machine, late_s, shift_m) -> None:
    settings = KeyframeBatchSettings(keyframes=100, datum=tuple(DATUM))
    told = list(recording(machine, late_s, shift_m))
    guess = FirstGuess(settings, machine)
    guess.start()
    guess.feed(told)
    found = guess.track()
    assert [one.stamp_s for one in found] == sorted(one.stamp_s for one in found)
    ends = found[0], found[len(found) // 2], found[-1]
    recorded((len(found), ends, len(guess.fixes), guess.fixes[3], guess.clock_s), relative=SOLVED)
    quantities = KeyframeBatch(settings, machine).calibrate(told)
    recorded(quantities, relative=0.01)


def test_nothing_is_found_without_motion(recorded, machine) -> None:
    guess = FirstGuess(KeyframeBatchSettings(datum=tuple(DATUM)), machine)
    guess.start()
    with pytest.raises(DataError) as refused:
        guess.feed(list(recording(machine, 0.0, 0.0))[:20])
    recorded(refused.value)


def test_states_go_on_with_each_sample(recorded, samples) -> None:
    start = InertialState(
        samples.at(1.0), turned(1.0).as_matrix(), place(1.0), np.ones(3), np.zeros(3), np.zeros(3)
    )
    recorded(propagate_through(start, samples.between(1.0, 1.31), GRAVITY))
