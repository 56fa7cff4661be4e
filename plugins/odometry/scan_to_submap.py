"""Lidar odometry against a rolling map of what was seen lately, by distribution-to-distribution matching."""

from dataclasses import dataclass

import numpy as np
import small_gicp
from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, MetersPerSecond, Radians, RadiansPerSecond, Settings
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import angle_between, exp_so3, log_so3
from executive.interfaces.odometry import LidarOdometry
from executive.messages.lidar import LidarScan
from executive.messages.odometry import LidarIncrement
from plugins.odometry.sweep import undistort


class ScanToSubmapSettings(Settings):
    """Settings of the odometry."""

    frame: str = Field("lidar_horizontal", description="The lidar to follow; scans of others are left alone.")
    near_m: Meters = Field(2.5, ge=0, description="Returns nearer than this are the machine's own [m].")
    far_m: Meters = Field(60.0, gt=0, description="Returns farther than this are left out [m].")
    scan_voxel_m: Meters = Field(0.25, gt=0, le=2, description="Grid edge to thin a scan [m].")
    map_voxel_m: Meters = Field(0.5, gt=0, le=5, description="Grid edge of the submap's Gaussians [m].")
    neighbours: int = Field(15, ge=5, le=100, description="Points for a return's covariance.")
    max_distance_m: Meters = Field(1.0, gt=0, description="Largest distance of a correspondence [m].")
    least_inliers: float = Field(0.5, gt=0, le=1, description="Share of a scan's points that must match.")
    max_speed_m_s: MetersPerSecond = Field(3.0, gt=0, description="Fastest sensor motion that is believed [m/s].")
    max_rate_rad_s: RadiansPerSecond = Field(1.5, gt=0, description="Fastest turn that is believed [rad/s].")
    key_distance_m: Meters = Field(0.3, gt=0, description="Motion after which a scan joins the submap [m].")
    key_angle_rad: Radians = Field(0.15, gt=0, description="Turn after which a scan joins the submap [rad].")
    restart_after: int = Field(10, gt=0, description="Scans refused in a row until the submap is begun anew.")
    rotation_std_rad: Radians = Field(0.003, gt=0, description="Standard deviation of an increment's rotation [rad].")
    translation_std_m: Meters = Field(0.02, gt=0, description="Standard deviation of its translation [m].")


@dataclass(frozen=True, slots=True, eq=False)
class _Track:
    """The last trusted pose of the sensor in the submap, and the motion that led to it."""

    stamp_s: float
    T_map_lidar: Float
    increment: Float
    duration_s: float


class ScanToSubmap(LidarOdometry):
    """The registration part of a lidar odometry and mapping system (Nubert 2022, Sec. IV-A4), in its plain form.

    Each scan is undistorted by the last motion, matched to a map of Gaussians (voxelised GICP, Koide 2021), and added
    to it after some motion. The paper's front end, CompSLAM, uses edge and plane features instead.
    """

    Settings = ScanToSubmapSettings

    def __init__(self, settings: ScanToSubmapSettings) -> None:
        self._settings = settings

    def start(self) -> None:
        self._track: _Track | None = None

    def add_scan(self, scan: LidarScan) -> LidarIncrement | None:
        if scan.frame != self._settings.frame:
            return None
        if self._track is None:
            self._begin(scan)
            return None
        track = self._track
        duration_s = scan.stamp_s - track.stamp_s
        if duration_s <= 0:
            return None
        ahead = _repeated(track.increment, duration_s / track.duration_s)
        source = self._thinned(undistort(scan, ahead, duration_s))
        if source.size() < self._settings.neighbours:
            self._refuse(scan)
            return None
        result = small_gicp.align(
            self._submap,
            source,
            init_T_target_source=track.T_map_lidar @ ahead,
            max_correspondence_distance=self._settings.max_distance_m,
            num_threads=1,
        )
        T_from_to = inverse(track.T_map_lidar) @ result.T_target_source
        if not self._is_plausible(result, source.size(), T_from_to, duration_s):
            self._refuse(scan)
            return None
        self._accept(_Track(scan.stamp_s, np.array(result.T_target_source), T_from_to, duration_s), source)
        return LidarIncrement(track.stamp_s, scan.stamp_s, scan.frame, T_from_to, self._covariance())

    def _begin(self, scan: LidarScan) -> None:
        """Found a new submap on one scan, taken as if the sensor stood still."""
        source = self._thinned(scan.points_lidar)
        if source.size() < self._settings.neighbours:
            return
        self._submap = small_gicp.GaussianVoxelMap(self._settings.map_voxel_m)
        self._submap.insert(source)
        self._T_map_key = np.eye(4)
        self._refusals = 0
        self._track = _Track(scan.stamp_s, np.eye(4), np.eye(4), 1.0)

    def _thinned(self, points: Float) -> small_gicp.PointCloud:
        settings = self._settings
        distance = np.linalg.norm(points, axis=1)
        kept = points[(distance > settings.near_m) & (distance < settings.far_m)]
        if not len(kept):
            return small_gicp.PointCloud(np.zeros((0, 3)))
        return small_gicp.preprocess_points(kept, settings.scan_voxel_m, settings.neighbours, 1)[0]

    def _is_plausible(
        self, result: small_gicp.RegistrationResult, size: int, T_from_to: Float, duration_s: float
    ) -> bool:
        settings = self._settings
        speed_m_s = float(np.linalg.norm(T_from_to[:3, 3])) / duration_s
        rate_rad_s = angle_between(np.eye(3), T_from_to[:3, :3]) / duration_s
        has_matched = result.converged and result.num_inliers >= settings.least_inliers * size
        return bool(has_matched and speed_m_s < settings.max_speed_m_s and rate_rad_s < settings.max_rate_rad_s)

    def _accept(self, track: _Track, source: small_gicp.PointCloud) -> None:
        self._track = track
        self._refusals = 0
        T_key_lidar = inverse(self._T_map_key) @ track.T_map_lidar
        moved_m = np.linalg.norm(T_key_lidar[:3, 3])
        turned_rad = angle_between(np.eye(3), T_key_lidar[:3, :3])
        if moved_m > self._settings.key_distance_m or turned_rad > self._settings.key_angle_rad:
            self._submap.insert(source, track.T_map_lidar)
            self._T_map_key = track.T_map_lidar

    def _refuse(self, scan: LidarScan) -> None:
        self._refusals += 1
        if self._refusals >= self._settings.restart_after:
            self._begin(scan)

    def _covariance(self) -> Float:
        """Return a fixed covariance: the Hessian of a match speaks of its noise, not of the scene's shape."""
        std = np.repeat([self._settings.rotation_std_rad, self._settings.translation_std_m], 3)
        return np.asarray(np.diag(std**2))


def _repeated(T: Float, times: float) -> Float:
    """Return a motion a number of times, as for a body that keeps its speed: rotation and translation apart."""
    return pose(exp_so3(times * log_so3(T[:3, :3])), times * T[:3, 3])
