"""Settings of the odometry plugins, apart from them: reading a mission imports no algorithm."""

from typing import ClassVar

from pydantic import Field

from executive.config import Meters, MetersPerSecond, Radians, RadiansPerSecond, Seconds
from executive.interfaces.declaration import PluginSettings


class KissIcpSettings(PluginSettings):
    """Settings of the odometry."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)

    frame: str = Field(
        "lidar_horizontal", description="The lidar to use; scans of other lidars are ignored."
    )
    near_m: Meters = Field(
        2.5,
        ge=0,
        description="Nearer returns are ignored, since most are of the machine itself [m].",
    )
    far_m: Meters = Field(60.0, gt=0, description="Farther returns are ignored [m].")
    voxel_m: Meters = Field(0.5, gt=0, le=5, description="Grid edge of the local map [m].")
    points_per_voxel: int = Field(20, ge=1, le=200, description="Most points in a cell of the map.")
    first_threshold_m: Meters = Field(
        1.0, gt=0, le=10, description="Largest distance of correspondences at the start [m]."
    )
    longest_gap_s: Seconds = Field(
        2.0, gt=0, le=2.5, description="Time without a scan after which a new map is started [s]."
    )
    max_speed_m_s: MetersPerSecond = Field(
        15.0, gt=0, description="Fastest plausible motion of the sensor [m/s]."
    )
    max_rate_rad_s: RadiansPerSecond = Field(
        1.5, gt=0, description="Fastest plausible rotation of the sensor [rad/s]."
    )
    rotation_std_rad: Radians = Field(
        0.02,
        gt=0,
        description="Error of an increment's rotation [rad]; measured on level ground, swinging.",
    )
    translation_std_m: Meters = Field(
        0.05, gt=0, description="Error of an increment's translation [m]; measured likewise."
    )


class ScanToSubmapSettings(PluginSettings):
    """Settings of the odometry."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)

    frame: str = Field(
        "lidar_horizontal", description="The lidar to use; scans of other lidars are ignored."
    )
    near_m: Meters = Field(
        2.5,
        ge=0,
        description="Nearer returns are ignored, since most are of the machine itself [m].",
    )
    far_m: Meters = Field(60.0, gt=0, description="Farther returns are ignored [m].")
    scan_voxel_m: Meters = Field(0.15, gt=0, le=2, description="Grid edge to thin a scan [m].")
    map_voxel_m: Meters = Field(0.15, gt=0, le=2, description="Grid edge to thin the submap [m].")
    plane_radius_m: Meters = Field(
        0.45, gt=0, le=5, description="Radius of the neighbourhood that a plane is fitted to [m]."
    )
    neighbours: int = Field(16, ge=6, le=100, description="Most neighbours in a plane.")
    first_distance_m: Meters = Field(
        1.0, gt=0, description="Largest distance of a correspondence in the first step [m]."
    )
    last_distance_m: Meters = Field(
        0.3, gt=0, description="Largest distance of a correspondence in the last steps [m]."
    )
    least_share: float = Field(
        0.1,
        gt=0,
        le=1,
        description="Smallest share of a scan's points on planes; one scan gives few planes.",
    )
    key_distance_m: Meters = Field(
        0.5, gt=0, description="Distance from all scans of the submap at which a scan is added [m]."
    )
    key_angle_rad: Radians = Field(
        0.12,
        gt=0,
        description="Rotation from all scans of the submap at which a scan is added [rad].",
    )
    key_scans: int = Field(40, ge=1, le=500, description="Most scans in the submap.")
    longest_gap_s: Seconds = Field(
        2.0,
        gt=0,
        le=2.5,
        description="Time without a matched scan after which a new submap is started [s].",
    )
    restart_after: int = Field(
        10,
        gt=0,
        description="Consecutive scans that do not match after which a new submap is started.",
    )
    guess_rotation_std_rad: Radians = Field(
        0.005,
        gt=0,
        description="Error of a scan's dead reckoning [rad]; large, so that increments do not "
        "depend on the gyroscope.",
    )
    guess_translation_std_m: Meters = Field(
        0.02, gt=0, description="Error of a scan's dead reckoning [m]."
    )
    doubt: float = Field(
        2.0,
        ge=1,
        le=10,
        description="Factor on the fit's standard deviation: errors on one plane are correlated.",
    )
