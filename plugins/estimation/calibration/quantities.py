"""What was solved for, as quantities of sensors: in the link's axes, with bound and advice."""

from collections.abc import Iterator, Sequence

import numpy as np
from executive_plugins.estimation.calibration.keyframe_problem import Solved
from executive_plugins.estimation.calibration.motion_track import MotionTrack
from executive_plugins.estimation.calibration.odometry_fit import (
    ARM,
    LATE,
    TURN,
    OdometryFit,
    OdometryProblem,
)
from executive_plugins.estimation.calibration.sample_noise import white_noise
from executive_plugins.estimation.calibration.settings import KeyframeBatchSettings
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from scipy.spatial.transform import Rotation

from executive.arrays import Float
from executive.geometry.pose import inverse
from executive.interfaces.calibration import Quantity
from executive.machine.rig import Rig
from executive.machine.sensor import Imu
from executive.messages.odometry import LidarIncrement

_TWO_SIDED_95 = 1.96
_TOO_FEW = "more samples: some seconds of them"
_SCALE_ADVICE = "no change: measurements err by no more than they declare"
_CLOCK_ADVICE = "motion that starts, halts and turns while there are fixes of centimetres"
_ARM_ADVICE = "turns about the two axes across it: yaw for x and y, roll or pitch for z"
_TURN_ADVICE = "turns about at least two axes, or longer ways"


def _within(std: Float, bound: float) -> np.ndarray:
    return np.asarray(_TWO_SIDED_95 * np.atleast_1d(std) <= bound)


def _quantity(
    sensor: str, name: str, found: tuple[Float, Float, Float], bound: float, advice: str
) -> Quantity:
    """Return a quantity of (value, std, declared) that is found within a 95 % bound."""
    value, std, declared = (np.atleast_1d(np.asarray(one, dtype=float)) for one in found)
    is_found = _within(std, bound)
    return Quantity(sensor, name, value, std, declared, is_found, "" if is_found.all() else advice)


def inertial_quantities(imu: Imu, samples: SampleBuffer) -> list[Quantity]:
    """Return rate and white noise of the inertial sensor."""
    stamps_s, rates, forces = samples.arrays()
    steps_s = np.diff(stamps_s)
    found = []
    if len(steps_s):
        rate_hz = 1.0 / float(np.median(steps_s))
        declared = (np.array(rate_hz), np.zeros(1), np.array(imu.rate_hz))
        found.append(_quantity(imu.name, "rate_hz", declared, np.inf, ""))
    for name, values in (("gyro_noise_rad_s", rates), ("accel_noise_m_s2", forces)):
        before = np.array(getattr(imu, name))
        noise = white_noise(values)
        value, std = (before, np.array(np.inf)) if noise is None else map(np.array, noise)
        bound = 0.5 * float(value)  # half of the figure itself
        found.append(_quantity(imu.name, name, (value, std, before), bound, _TOO_FEW))
    return found


def receiver_quantities(
    solved: Solved, rig: Rig, imu: Imu, settings: KeyframeBatchSettings
) -> Iterator[Quantity]:
    """Yield arm, clock and scale of each antenna."""
    unknowns, P = solved.unknowns, solved.covariance
    names = list(unknowns.arms_imu)
    R, t = imu.T_link_sensor[:3, :3], imu.T_link_sensor[:3, 3]
    for number, receiver in enumerate(unknowns.receivers):
        clock = 3 * len(names) + number
        late = (np.array(receiver.late_s), np.sqrt(P[clock, clock]), np.zeros(1))
        scale_std = receiver.scale * np.sqrt(2.0 / solved.free)
        for name in receiver.antennas:
            yield _quantity(name, "stamp_late_s", late, settings.clock_bound_s, _CLOCK_ADVICE)
            i = 3 * names.index(name)
            arm = R @ unknowns.arms_imu[name] + t
            std = np.sqrt(np.diag(R @ P[i : i + 3, i : i + 3] @ R.T))
            declared = np.array(rig.sensors[name].xyz_m)
            yield _quantity(name, "xyz_m", (arm, std, declared), settings.arm_bound_m, _ARM_ADVICE)
            yield _scale(name, receiver.scale, scale_std)


def _motion_covariance(solved: Solved) -> Float:
    """Return what the motion errs by as a lever arm does [m²], IMU axes, shape (3, 3).

    The motion of the IMU is that of the best known antenna, moved by its arm.
    """
    blocks = [
        solved.covariance[i : i + 3, i : i + 3]
        for i in range(0, 3 * len(solved.unknowns.arms_imu), 3)
    ]
    return min(blocks, key=np.trace)


def odometry_quantities(
    increments: Sequence[LidarIncrement],
    solved: Solved,
    samples: SampleBuffer,
    rig: Rig,
    imu: Imu,
    settings: KeyframeBatchSettings,
) -> Iterator[Quantity]:
    """Yield mounting, clock and scale of each sensor that measures increments on the IMU's link."""
    track = MotionTrack(solved.states, samples, settings.gravity_m_s2)
    stds = (settings.turn_std_rad, settings.arm_std_m, settings.unknown_clock_s)
    for frame in sorted({one.frame for one in increments}):
        sensor = rig.sensors.get(frame)
        if sensor is None or sensor.link != imu.link:
            continue
        T_imu_sensor = inverse(imu.T_link_sensor) @ sensor.T_link_sensor
        own = [one for one in increments if one.frame == frame]
        problem = OdometryProblem(own, track, T_imu_sensor, stds)
        fit = problem.solved() if problem.is_enough else None
        if fit is not None:
            fit.covariance[ARM, ARM] += _motion_covariance(solved)
            R = fit.T_imu_sensor[:3, :3]
            fit.covariance[TURN, TURN] += R.T @ solved.attitude @ R
            yield from _fitted(frame, fit, rig, imu, settings)


def _fitted(
    frame: str, fit: OdometryFit, rig: Rig, imu: Imu, settings: KeyframeBatchSettings
) -> Iterator[Quantity]:
    sensor, P = rig.sensors[frame], fit.covariance
    T = imu.T_link_sensor @ fit.T_imu_sensor
    R = imu.T_link_sensor[:3, :3]
    late = (np.array(fit.late_s), np.sqrt(P[LATE, LATE]), np.zeros(1))
    yield _quantity(frame, "stamp_late_s", late, settings.clock_bound_s, _CLOCK_ADVICE)
    std = np.sqrt(np.diag(R @ P[ARM, ARM] @ R.T))
    arm = (T[:3, 3], std, np.array(sensor.xyz_m))
    yield _quantity(frame, "xyz_m", arm, settings.arm_bound_m, _ARM_ADVICE)
    rpy = Rotation.from_matrix(T[:3, :3]).as_euler("xyz")
    turn = (
        rpy,
        np.sqrt(np.diag(T[:3, :3] @ P[TURN, TURN] @ T[:3, :3].T)),
        np.array(sensor.rpy_rad),
    )
    yield _quantity(frame, "rpy_rad", turn, settings.turn_bound_rad, _TURN_ADVICE)
    std_of_scale = fit.misfit * np.sqrt(2.0 / fit.free)
    yield _scale(frame, fit.misfit, std_of_scale)


def _scale(sensor: str, scale: float, std: float) -> Quantity:
    """Return the factor on a declared covariance; one below 1 does not count as found.

    Residuals that are too small may as well be due to inertial noise that is less than assumed,
    and a covariance that is too small makes an estimator refuse what is right.
    """
    found = (np.array(scale), np.array(std), np.ones(1))
    bound = 0.5 * scale if scale > 1.0 else 0.0
    return _quantity(sensor, "covariance_scale", found, bound, _SCALE_ADVICE)
