"""The white noise of a machine's sensors, by their sheet, on samples of ideal ones."""

from dataclasses import replace

import numpy as np

from executive.geometry.geodesy import enu_from_geodetic, geodetic_from_enu
from executive.machine.machine import Machine
from executive.machine.sensor import Encoders, Gnss, Imu
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.observation import Observation


class SensorNoise:
    """Adds noise to samples; biases and their walks are left out."""

    def __init__(self, machine: Machine, rng: np.random.Generator) -> None:
        self._machine, self._rng = machine, rng
        self._encoders = next(iter(machine.sensors_of("encoders")), None)

    def on(self, sample: Observation) -> Observation:
        """Return a sample with noise."""
        if isinstance(sample, JointSample):
            return self._on_joints(sample)
        if isinstance(sample, ImuSample):
            return self._on_imu(sample)
        return self._on_fix(sample) if isinstance(sample, GnssFix) else sample

    def _on_joints(self, sample: JointSample) -> JointSample:
        sheet = self._encoders
        if not isinstance(sheet, Encoders):
            return sample
        kinds = [joint.kind for joint in self._machine.joints] + ["revolute"]
        length, angle = sheet.length_noise_m, sheet.angle_noise_rad
        position = [length if kind == "prismatic" else angle for kind in kinds]
        limits = [joint.max_effort for joint in (*self._machine.joints, self._machine.jaw)]
        n = len(sample.names)
        return replace(
            sample,
            position=sample.position + np.array(position) * self._rng.standard_normal(n),
            velocity=sample.velocity + sheet.velocity_noise * self._rng.standard_normal(n),
            effort=sample.effort
            + sheet.effort_noise * np.array(limits) * self._rng.standard_normal(n),
        )

    def _on_imu(self, sample: ImuSample) -> ImuSample:
        sheet = self._machine.sensors[sample.frame]
        if not isinstance(sheet, Imu):
            return sample
        rate, force = self._rng.standard_normal((2, 3))
        return replace(
            sample,
            angular_velocity_rad_s=sample.angular_velocity_rad_s + sheet.gyro_noise_rad_s * rate,
            specific_force_m_s2=sample.specific_force_m_s2 + sheet.accel_noise_m_s2 * force,
        )

    def _on_fix(self, fix: GnssFix) -> GnssFix:
        sheet = self._machine.sensors[fix.antenna]
        if not isinstance(sheet, Gnss):
            return fix
        std = np.array([sheet.horizontal_noise_m] * 2 + [sheet.vertical_noise_m])
        at = enu_from_geodetic(fix.geodetic, fix.geodetic) + std * self._rng.standard_normal(3)
        return replace(fix, geodetic=geodetic_from_enu(at, fix.geodetic))
