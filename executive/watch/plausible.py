"""Whether a sample can be true on this machine: ranges, limits, and the step from the one before.

Each function returns why a sample cannot be true; empty if it can. The bounds come from the
machine's description: limits of joints, ranges and noise of sensors.
"""

import math

import numpy as np

from executive.arrays import Float
from executive.geometry.rotation import exp_so3
from executive.machine.machine import Machine
from executive.machine.sensor import Encoders, Imu, Lidar
from executive.messages.command import START_TOLERANCE
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan

SIGMAS = 6.0  # of noise: once in 10⁹ samples
# A joint moves faster than its limit for moments, when a load slips. A stone that slides out of the
# jaws drives them at up to 2.7 times their own speed, in one MuJoCo mission of two stones.
_ARM_MARGIN, _JAW_MARGIN = 2.0, 6.0
_EFFORT_MARGIN = 1.1
_FEW = 0.01  # share of a scan's returns that may lie outside the sensor's range
_PERIODS = 1.5  # up to so many periods two samples follow each other


class JointBounds:
    """What joint samples of a machine can be."""

    def __init__(self, machine: Machine, encoders: Encoders) -> None:
        joints = (*machine.joints, machine.jaw)
        self._names = machine.joint_names
        is_length = np.array([joint.kind == "prismatic" for joint in machine.joints] + [False])
        self._noise = np.where(is_length, encoders.length_noise_m, encoders.angle_noise_rad)
        self._lower = np.append(machine.lower, machine.jaw.lower) - START_TOLERANCE
        self._upper = np.append(machine.upper, machine.jaw.upper) + START_TOLERANCE
        self._speed_noise = SIGMAS * encoders.velocity_noise
        margin = np.append(np.full(len(machine.joints), _ARM_MARGIN), _JAW_MARGIN)
        self._speed = margin * np.array([joint.max_velocity for joint in joints])
        efforts = np.array([joint.max_effort for joint in joints])
        self._effort = (_EFFORT_MARGIN + SIGMAS * encoders.effort_noise) * efforts

    def refusal(self, sample: JointSample) -> str:
        """Return why a sample alone cannot be true."""
        if sample.names != self._names:
            return f"joints {', '.join(sample.names)}, expected {', '.join(self._names)}"
        q, dq, effort = sample.position, sample.velocity, sample.effort
        beyond = (q < self._lower) | (q > self._upper)
        if beyond.any():
            return self._told("is at", q, beyond, "outside its range")
        fast = np.abs(dq) > self._speed + self._speed_noise
        if fast.any():
            return self._told("moves at", dq, fast, "faster than it can")
        strong = np.abs(effort) > self._effort
        return (
            self._told("has the effort", effort, strong, "beyond its limit") if strong.any() else ""
        )

    def step(self, before: JointSample, sample: JointSample) -> str:
        """Return why a sample cannot follow another one, however the joints have moved."""
        dt_s = sample.stamp_s - before.stamp_s
        moved = np.abs(sample.position - before.position)
        limit = 2 * SIGMAS * self._noise + self._speed * dt_s
        return (
            self._told("has jumped by", moved, moved > limit, "") if (moved > limit).any() else ""
        )

    def _told(self, verb: str, values: Float, which: np.ndarray, end: str) -> str:
        i = int(np.argmax(which))
        return f"{self._names[i]} {verb} {values[i]:.4g}{f', {end}' if end else ''}"


def imu_refusal(imu: Imu, sample: ImuSample) -> str:
    """Return why an inertial sample is outside of the sensor's ranges."""
    rate = float(np.abs(sample.angular_velocity_rad_s).max())
    if rate > imu.gyro_range_rad_s:
        return f"{rate:.4g} rad/s is beyond its range of {imu.gyro_range_rad_s:g} rad/s"
    force = float(np.abs(sample.specific_force_m_s2).max())
    if force > imu.accel_range_m_s2:
        return f"{force:.4g} m/s² is beyond its range of {imu.accel_range_m_s2:g} m/s²"
    return ""


class TurnRate:
    """Compares the angular velocities of cabin and chassis with the encoder between them."""

    def __init__(self, machine: Machine) -> None:
        self._turn = next(j for j in machine.joints if j.name == machine.turn_joint)
        self._links = (machine.base_link, machine.cabin_link)
        self._axis = np.array(self._turn.axis)
        encoders = next(iter(machine.sensors_of("encoders")), None)
        self._speed_noise = encoders.velocity_noise if isinstance(encoders, Encoders) else 0.0

    def refusal(
        self, imu: Imu, sample: ImuSample, other: tuple[Imu, ImuSample], joints: JointSample
    ) -> str:
        """Return how an inertial sample contradicts the sensor on the other body.

        Of two that disagree, the one is refused whose own rate a standing chassis does not explain.

        Args:
            imu: The sensor, on the cabin or on the chassis.
            sample: Its sample.
            other: A sensor on the other body, with its newest sample.
            joints: The newest joint sample.
        """
        angle, speed, _ = joints.of(self._turn.name)
        variance = self._speed_noise**2 + sum(
            one.gyro_noise_rad_s**2 + one.gyro_bias_rad_s**2 for one in (imu, other[0])
        )
        apart_s = max(abs(sample.stamp_s - t) for t in (joints.stamp_s, other[1].stamp_s))
        limit = SIGMAS * math.sqrt(variance) + 2 * self._turn.max_acceleration * (
            apart_s + 1 / imu.rate_hz
        )
        rate = imu.T_link_sensor[:3, :3] @ sample.angular_velocity_rad_s
        turning = speed * self._axis
        if math.dist(rate, turning if imu.link == self._links[1] else (0.0,) * 3) <= limit:
            return ""  # a standing chassis explains it
        rates = {
            imu.link: rate,
            other[0].link: other[0].T_link_sensor[:3, :3] @ other[1].angular_velocity_rad_s,
        }
        by_turn = exp_so3(self._axis * angle).T @ rates[self._links[0]] + turning
        apart = math.dist(rates[self._links[1]], by_turn)
        if apart <= limit:
            return ""
        return f"{apart:.3f} rad/s off {other[0].name} and the turn joint"


def fix_refusal(fix: GnssFix) -> str:
    """Return why a fix is none."""
    latitude, longitude, altitude = fix.geodetic
    if abs(latitude) > 90 or abs(longitude) > 360 or abs(altitude) > 1e5:
        return f"({latitude:.4g}°, {longitude:.4g}°, {altitude:.4g} m) is no place near the ground"
    if not np.all(np.linalg.eigvalsh(fix.covariance_enu_m2) > 0):
        return "its covariance is not positive definite"
    return ""


def scan_refusal(lidar: Lidar, scan: LidarScan) -> str:
    """Return why a revolution cannot be one of the sensor."""
    if not len(scan.points_lidar):
        return ""
    ranges = np.linalg.norm(scan.points_lidar, axis=1)
    slack_m = SIGMAS * lidar.range_noise_m
    low, high = lidar.range_m[0] - slack_m, lidar.range_m[1] + slack_m
    share = float(np.mean((ranges < low) | (ranges > high)))
    if share > _FEW:
        return f"{100 * share:.0f} % of its returns are outside {low:.1f} … {high:.1f} m"
    longest_s = scan.stamp_s - float(scan.point_stamps_s[0])
    if longest_s > 2 / lidar.rate_hz:
        return f"its first return is {longest_s:.2f} s older than its end"
    return ""
