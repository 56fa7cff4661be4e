"""A log whose body, motion and sensors are drawn from a seed."""

from dataclasses import dataclass, replace

import numpy as np

from drawn_logs.measuring import IMU, LIDAR, antenna_name, inertial, odometric, satellite
from drawn_logs.motion import KINDS, Motion, draw_motion
from drawn_logs.sheets import GnssSheet, ImuSheet, OdometrySheet
from executive.arrays import Float
from executive.logs.log import Arrival
from executive.machine.rig import Rig

DATUM = np.array([47.4084, 8.5106, 440.0])


@dataclass(frozen=True, slots=True, eq=False)
class DrawnLog:
    """Measurements in order of arrival, the rig as its maker declares it, and the truth.

    Attributes:
        seed: What it was drawn from.
        rig: The body with its sensors.
        arrivals: All measurements.
        motion: The truth.
        imu: The inertial sensor.
        gnss: The receiver.
        odometry: Odometry; None if the body has none.
    """

    seed: int
    rig: Rig
    arrivals: tuple[Arrival, ...]
    motion: Motion
    imu: ImuSheet
    gnss: GnssSheet
    odometry: OdometrySheet | None

    @property
    def datum(self) -> Float:
        """Origin of the map: latitude [deg], longitude [deg], altitude [m], shape (3,)."""
        return DATUM

    @property
    def words(self) -> str:
        """What was drawn, in one line."""
        gnss = self.gnss
        kind = "fixed" if gnss.is_rtk_fixed else "not fixed"
        return (
            f"{self.seed} {self.motion.kind}, moves from {self.motion.moves_from_s:.0f} s, imu "
            f"{self.imu.rate_hz:.0f} Hz, gnss {gnss.rate_hz:.0f} Hz {100 * gnss.horizontal_m:.1f} "
            f"cm × {gnss.truth:.1f} {kind}, {len(gnss.antennas)} antennas, clock "
            f"{1e3 * gnss.offset_s:+.0f} ms{', odometry' if self.odometry else ''}"
        )


def draw_log(seed: int, duration_s: float = 90.0, is_sound: bool = False) -> DrawnLog:
    """Draw a log; half of the bodies move from the first sample on.

    Args:
        seed: What it is drawn from.
        duration_s: Length [s].
        is_sound: Whether the receiver errs as it declares and its clock agrees, and the body has
            odometry; what else is drawn is the same.
    """
    rng = np.random.default_rng(seed)
    kind = KINDS[seed % len(KINDS)]
    rests_s = 0.0 if rng.random() < 0.5 else rng.uniform(1.0, 15.0)
    imu, gnss = ImuSheet.draw(rng), GnssSheet.draw(rng)
    odometry = OdometrySheet.draw(rng) if rng.random() < 0.5 or is_sound else None
    if is_sound:
        gnss = replace(gnss, truth=1.0, offset_s=0.0)
    motion = draw_motion(kind, rng, duration_s, imu.rate_hz, rests_s)
    arrivals = [*inertial(motion, imu, rng), *satellite(motion, gnss, DATUM, rng)]
    if odometry is not None:
        arrivals += odometric(motion, odometry, rng)
    arrivals.sort(key=lambda arrival: arrival.arrival_s)
    return DrawnLog(seed, _rig(imu, gnss, odometry), tuple(arrivals), motion, imu, gnss, odometry)


def _rig(imu: ImuSheet, gnss: GnssSheet, odometry: OdometrySheet | None) -> Rig:
    """Return the rig with the data sheets that the makers print; biases by their typical size."""
    at = {"link": "base", "provenance": "guess"}
    sensors: dict[str, dict[str, object]] = {
        IMU: {
            "kind": "imu",
            "rate_hz": imu.rate_hz,
            "gyro_noise_rad_s": imu.gyro_std,
            "gyro_bias_rad_s": float(np.linalg.norm(imu.gyro_bias)),
            "gyro_walk_rad_s": imu.gyro_walk,
            "accel_noise_m_s2": imu.accel_std,
            "accel_bias_m_s2": float(np.linalg.norm(imu.accel_bias)),
            "accel_walk_m_s2": imu.accel_walk,
        }
    }
    for number, antenna in enumerate(gnss.antennas):
        sensors[antenna_name(number)] = {
            "kind": "gnss",
            "rate_hz": gnss.rate_hz,
            "xyz_m": tuple(map(float, antenna)),
            "horizontal_noise_m": gnss.horizontal_m,
            "vertical_noise_m": gnss.vertical_m,
        }
    if odometry is not None:
        sensors[LIDAR] = {
            "kind": "lidar",
            "rate_hz": odometry.rate_hz,
            "lasers": 16,
            "elevation_rad": (-0.26, 0.26),
            "azimuth_step_rad": 0.0035,
            "range_m": (0.4, 100.0),
            "range_noise_m": 0.02,
        }
    named = {name: {**at, "name": name, **sensor} for name, sensor in sensors.items()}
    return Rig.model_validate({"name": "base", "sensors": named})
