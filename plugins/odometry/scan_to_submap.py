"""Lidar odometry that registers each scan to a rolling map of recent scans."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import small_gicp
from executive_plugins.odometry.dead_reckoning import DeadReckoning
from executive_plugins.odometry.own_returns import OwnReturns
from executive_plugins.odometry.plane_fit import Guess, PlaneFit, fit
from executive_plugins.odometry.plane_map import PlaneMap
from executive_plugins.odometry.sensor_path import SensorPath
from executive_plugins.odometry.settings import ScanToSubmapSettings

from executive.arrays import Float
from executive.geometry.pose import adjoint, inverse
from executive.interfaces.odometry import LidarOdometry
from executive.machine.rig import Rig
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan
from executive.messages.odometry import LidarIncrement

_REVOLUTION_S = 0.1  # time over which the first scan is undistorted


@dataclass(frozen=True, slots=True, eq=False)
class _Track:
    """The last accepted pose of the sensor in the submap, and the covariance of its fit."""

    stamp_s: float
    T_map_lidar: Float
    covariance: Float


class ScanToSubmap(LidarOdometry):
    """The registration part of a lidar odometry and mapping system (Nubert 2022, Sec. IV-A4).

    Returns of the machine itself are removed from each scan. The scan is undistorted by gyroscope
    and joints, registered to the planes of a map of earlier scans, and added to the map if none was
    taken near its pose. Deviations from the paper: its front end, CompSLAM, matches edge and plane
    features of single rings; and the covariance here is that of the fit.

    Inertial measurements serve as a guess and for undistortion only. If an increment depended on
    the gyroscope, an estimator that also uses the gyroscope would find its bias to be zero.
    """

    Settings = ScanToSubmapSettings

    def __init__(self, settings: ScanToSubmapSettings, machine: Rig) -> None:
        self._settings = settings
        self._machine = machine

    @classmethod
    def settings_for(cls, lidars: Sequence[str]) -> Mapping[str, object]:
        default = cls.Settings.model_fields["frame"].default
        return {} if default in lidars else {"frame": lidars[0]}

    def start(self) -> None:
        self._track: _Track | None = None
        self._refusals = 0
        self._own = OwnReturns(self._machine)
        self._reckoning: DeadReckoning | None = None
        if self._settings.frame in self._machine.sensors:
            self._reckoning = DeadReckoning(self._machine, self._settings.frame)

    def add_imu(self, sample: ImuSample) -> None:
        if self._reckoning is not None:
            self._reckoning.add_imu(sample)

    def add_joints(self, sample: JointSample) -> None:
        if self._reckoning is not None:
            self._reckoning.add_joints(sample)
        self._own.add_joints(sample)

    def add_scan(self, scan: LidarScan) -> LidarIncrement | None:
        if scan.frame != self._settings.frame or self._reckoning is None:
            return None
        track = self._track
        if track is not None and scan.stamp_s <= track.stamp_s:
            return None
        if track is not None and scan.stamp_s - track.stamp_s > self._settings.longest_gap_s:
            track = None  # the motion during the gap is unknown
        from_s = scan.stamp_s - _REVOLUTION_S
        path = self._reckoning.path(
            from_s if track is None else min(from_s, track.stamp_s), scan.stamp_s
        )
        points = self._points(scan, path)
        if track is None:
            self._begin(scan.stamp_s, points)
            return None
        fitted = self._fitted(points, track.T_map_lidar @ inverse(path.T_end_then(track.stamp_s)))
        if fitted is None:
            self._refuse(scan.stamp_s, points)
            return None
        return self._accept(track, scan.stamp_s, fitted, points)

    def _points(self, scan: LidarScan, path: SensorPath) -> Float:
        """Return the returns of the surroundings, undistorted and thinned [m], shape (N, 3)."""
        distance = np.linalg.norm(scan.points_lidar, axis=1)
        kept = (
            (distance > self._settings.near_m)
            & (distance < self._settings.far_m)
            & ~self._own.among(scan)
        )
        points = path.undistort(scan.points_lidar[kept], scan.point_stamps_s[kept])
        if not len(points):
            return points
        return np.array(
            small_gicp.voxelgrid_sampling(points, self._settings.scan_voxel_m, 1).points()[:, :3]
        )

    def _begin(self, stamp_s: float, points: Float) -> None:
        """Start a new submap with one scan."""
        settings = self._settings
        if len(points) < settings.neighbours:
            return
        self._map = PlaneMap(
            settings.map_voxel_m, settings.plane_radius_m, settings.neighbours, settings.key_scans
        )
        self._map.add(np.eye(4), points)
        self._refusals = 0
        self._track = _Track(stamp_s, np.eye(4), np.zeros((6, 6)))

    def _fitted(self, points: Float, T_map_lidar: Float) -> PlaneFit | None:
        """Register a scan to the map; None if the result is not reliable."""
        settings = self._settings
        if len(points) < settings.neighbours:
            return None
        std = np.repeat([settings.guess_rotation_std_rad, settings.guess_translation_std_m], 3)
        guess = Guess(T_map_lidar, std)
        fitted = fit(points, self._map, guess, settings.first_distance_m, settings.last_distance_m)
        return fitted if fitted.has_converged and fitted.share >= settings.least_share else None

    def _accept(
        self, track: _Track, stamp_s: float, fitted: PlaneFit, points: Float
    ) -> LidarIncrement:
        settings, T = self._settings, fitted.T_map_lidar
        T_from_to = inverse(track.T_map_lidar) @ T
        covariance = settings.doubt**2 * fitted.covariance
        self._track = _Track(stamp_s, T, covariance)
        self._refusals = 0
        if self._map.is_new(T, settings.key_distance_m, settings.key_angle_rad):
            self._map.add(T, points)
        # Both ends were fitted: the error of the earlier one is expressed in the later frame.
        J = adjoint(inverse(T_from_to))
        both = J @ track.covariance @ J.T + covariance
        increment = LidarIncrement(track.stamp_s, stamp_s, settings.frame, T_from_to, both)
        if self._reckoning is not None:
            self._reckoning.correct(increment)
        return increment

    def _refuse(self, stamp_s: float, points: Float) -> None:
        self._refusals += 1
        if self._refusals >= self._settings.restart_after:
            self._begin(stamp_s, points)
