"""Scans to points in the map: self-filter and motion correction (Mascaro 2020, Sec. 4.2)."""

from collections.abc import Mapping

import numpy as np
from executive_plugins.mapping.deskew import cabin_poses, place, time_slices
from executive_plugins.mapping.settings import MapSettings

from executive.arrays import Float, read_only
from executive.errors import ConfigError, DataError, did_you_mean
from executive.geometry.pose import inverse
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.machine.self_filter import SelfFilter
from executive.messages.lidar import LidarScan
from executive.messages.motion import Motion


class ScanFrontEnd:
    """Self-filter and motion correction of one machine's lidars."""

    def __init__(self, machine: Machine, settings: MapSettings) -> None:
        """Prepare the shapes, and compile the inner loops.

        Raises:
            ConfigError: If the machine has no lidar.
        """
        self._machine = machine
        self._lidars = tuple(sensor.name for sensor in machine.sensors_of("lidar"))
        if not self._lidars:
            raise ConfigError(
                f"machine {machine.name} has no lidar to map with: add one to its robot.yaml"
            )
        self._kinematics = Kinematics(machine)
        self._filter = SelfFilter(machine, settings.padding_m, settings.shadow_m)
        self._nearest_m = settings.nearest_m
        self._slice_s = settings.slice_s
        names = machine.joint_names
        scan = LidarScan(0.0, self._lidars[0], np.full((1, 3), 3.0), np.zeros(1))
        motion = Motion(np.zeros(1), np.eye(4)[None], names, np.zeros((1, len(names))))
        self.place(scan, motion, 0.0)
        self.place_held(scan, motion, 1.0)

    def place(self, scan: LidarScan, motion: Motion, held_radius_m: float) -> Float:
        """Return the returns that are not of the machine, in the map [m], shape (K, 3).

        Args:
            scan: One revolution.
            motion: Cabin poses and joints during it.
            held_radius_m: Radius around the grasp centre within which returns are of a held object
            [m].

        Raises:
            DataError: If the sensor is no lidar of the machine, or the motion lacks a joint.
        """
        if scan.frame not in self._lidars:
            wrong = f"a scan comes from '{scan.frame}', which is no lidar of {self._machine.name}"
            raise DataError(wrong + did_you_mean(scan.frame, self._lidars))
        if not len(scan.points_lidar):
            return np.empty((0, 3))
        ends_s, slices, fractions = time_slices(scan, self._slice_s)
        frames = [self._frames(motion, float(stamp)) for stamp in ends_s]
        near = (scan.points_lidar**2).sum(axis=1) < self._nearest_m**2
        nearest_end = slices + (fractions > 0.5)
        own = self._filter.inside(scan.points_lidar, nearest_end, scan.frame, frames, held_radius_m)
        kept = ~(near | own)
        cabin = self._machine.cabin_link
        T_cabin_lidar = np.array([inverse(frame[cabin]) @ frame[scan.frame] for frame in frames])
        T_map_lidar = cabin_poses(motion, ends_s) @ T_cabin_lidar
        points = read_only(scan.points_lidar[kept])
        return np.asarray(place(points, slices[kept], fractions[kept], T_map_lidar))

    def place_held(self, scan: LidarScan, motion: Motion, held_radius_m: float) -> Float:
        """Return the returns around the grasp centre that are not of the machine, shape (K, 3).

        They are in the frame of the gripper at the time of each, so that what the jaws hold is at
        rest in them [m].

        Args:
            scan: One revolution, of a lidar of the machine.
            motion: Joints during it.
            held_radius_m: Radius around the grasp centre within which returns are kept [m].
        """
        if not len(scan.points_lidar) or held_radius_m <= 0:
            return np.empty((0, 3))
        ends_s, slices, fractions = time_slices(scan, self._slice_s)
        frames = [self._frames(motion, float(stamp)) for stamp in ends_s]
        T_gripper_lidar = np.array(
            [inverse(frame["gripper"]) @ frame[scan.frame] for frame in frames]
        )
        points = place(scan.points_lidar, slices, fractions, T_gripper_lidar)
        away_m = np.linalg.norm(points - self._machine.gripper.grasp_centre, axis=1)
        rows = np.flatnonzero(away_m <= held_radius_m)
        nearest_end = slices[rows] + (fractions[rows] > 0.5)
        own = self._filter.inside(scan.points_lidar[rows], nearest_end, scan.frame, frames, 0.0)
        return np.asarray(points[rows[~own]])

    def lidar_map(self, scan: LidarScan, motion: Motion) -> Float:
        """Return the position of a scan's lidar in the middle of the scan, in the map [m], (3,).

        At a swing of 10°/s it is 2 cm from where it was at the ends.
        """
        stamp_s = float(0.5 * (scan.point_stamps_s[0] + scan.point_stamps_s[-1]))
        return np.asarray(self.lidars_map(motion, stamp_s)[self._lidars.index(scan.frame)])

    def lidars_map(self, motion: Motion, stamp_s: float) -> Float:
        """Return the positions of the lidars at a time, in the map [m], shape (L, 3)."""
        frames = self._frames(motion, stamp_s)
        T_map_base = motion.T_map_cabin_at(stamp_s) @ inverse(frames[self._machine.cabin_link])
        return np.array([(T_map_base @ frames[lidar])[:3, 3] for lidar in self._lidars])

    def _frames(self, motion: Motion, stamp_s: float) -> Mapping[str, Float]:
        q = dict(zip(motion.joint_names, motion.joints_at(stamp_s), strict=True))
        missing = [name for name in self._machine.joint_names if name not in q]
        if missing:
            raise DataError(
                f"the motion lacks joint {', '.join(missing)}; it has "
                f"{', '.join(motion.joint_names)}"
            )
        arm = np.array([q[name] for name in self._machine.arm_names])
        return self._kinematics.frames(arm, float(q[self._machine.jaw.name]))
