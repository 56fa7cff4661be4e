"""Settings of the mapping plugins, apart from them: reading a mission imports no algorithm."""

from collections.abc import Iterator
from typing import ClassVar

from pydantic import Field

from executive.config import Meters, Radians, Seconds, Settings
from executive.interfaces.declaration import PluginSettings, Refusal
from executive.machine.machine import Machine


class OdometryNoiseSettings(Settings):
    """The estimate's error as a random walk with a correlation time.

    Defaults were measured on the shipped estimators, with satellites of 8 mm and of 40 mm: the
    random walk of their poses is the same.
    """

    rotation_rad: Radians = Field(
        0.002, gt=0, description="Random walk of the attitude in one second [rad]."
    )
    position_m: Meters = Field(
        0.0035, gt=0, description="Random walk of the position in one second [m]."
    )
    correlation_s: Seconds = Field(
        2.0, gt=0, description="Time after which errors are uncorrelated [s]."
    )
    anchor_period_s: Seconds = Field(
        1.0, gt=0, description="Time between two constraints to the estimated pose itself [s]."
    )
    unknown_rotation_rad: Radians = Field(
        0.003, gt=0, description="Rotation error if the estimate gives no covariance [rad]."
    )
    unknown_position_m: Meters = Field(
        0.01, gt=0, description="Position error if the estimate gives no covariance [m]."
    )


class ScanMatchingSettings(Settings):
    """Settings of the submap and the fit, and conditions for using a fit."""

    pairs: int = Field(10, ge=1, le=100, description="Scan pairs in the submap, m.")
    pair_voxel_m: Meters = Field(0.2, gt=0, le=2, description="Grid edge to thin a pair [m].")
    submap_voxel_m: Meters = Field(
        0.15, gt=0, le=2, description="Grid edge to thin the submap [m]."
    )
    neighbours: int = Field(
        10,
        ge=5,
        le=100,
        description="Number of neighbours from which a point's covariance is computed.",
    )
    max_distance_m: Meters = Field(
        0.2, gt=0, le=5, description="Largest distance of a correspondence [m]."
    )
    least_inliers: float = Field(
        0.6, gt=0, le=1, description="Smallest share of a pair's points that must match."
    )
    max_shift_m: Meters = Field(
        0.15, gt=0, description="Largest correction of the odometry that is accepted [m]."
    )
    max_turn_rad: Radians = Field(
        0.03, gt=0, description="Largest correction of its rotation that is accepted [rad]."
    )
    covariance_factor: float = Field(
        0.25,
        gt=0,
        le=100,
        description="True variance of a fit over its inverse Hessian, measured in the simulation.",
    )
    least_std_m: Meters = Field(
        5e-4,
        gt=0,
        description="Lower bound on a match's standard deviation [m], and the same in [rad].",
    )


class MapSettings(PluginSettings):
    """Extent and resolution of a map, and the returns that it excludes."""

    voxel_m: Meters = Field(0.03, gt=0, le=1, description="Edge of a voxel, res_voxel [m].")
    min_points: int = Field(
        2, ge=1, description="Number of returns from which a voxel counts as occupied, n_min."
    )
    radius_m: Meters = Field(
        10.0, gt=0, description="Radius of the mapped cylinder around the cabin, R_map [m]."
    )
    padding_m: Meters = Field(
        0.10,
        ge=0,
        le=1,
        description="Returns nearer than this to a link count as the machine's [m].",
    )
    shadow_m: Meters = Field(
        0.02,
        ge=0,
        le=1,
        description="Returns whose ray is nearer than this to a link are dropped; 0: none [m].",
    )
    nearest_m: Meters = Field(0.6, ge=0, description="Nearer returns are dropped [m].")
    slice_s: Seconds = Field(
        0.01, gt=0, description="Time over which the joints are treated as constant [s]."
    )
    smoothing_m: Meters = Field(
        0.045, ge=0, le=1, description="Distance over which range noise is averaged; 0: none [m]."
    )
    memory: int = Field(
        100, ge=1, description="Number of returns over which a voxel's mean is taken."
    )

    def refusals(self, machine: Machine) -> Iterator[Refusal]:
        if not any(sensor.kind == "lidar" for sensor in machine.sensors.values()):
            told = f"{machine.name} has no lidar to map with: add one to its robot.yaml"
            yield Refusal((), told)


class PoseGraphSettings(MapSettings):
    """Settings of the pose graph, in addition to those of all maps."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)

    process: bool = Field(
        False, description="Solve in a separate process; false gives the same map on each run."
    )
    answer_within_s: Seconds = Field(
        2.0,
        gt=0.05,
        le=60,
        description="Time without an answer after which the process is replaced [s].",
    )
    travel_m: Meters = Field(
        0.01, gt=0, description="Distance that a lidar moves until the next node, d_poses [m]."
    )
    pairs_at_rest: int = Field(
        20, ge=1, description="Largest number of pairs of one node that are inserted at rest."
    )
    window: int = Field(
        300,
        ge=20,
        le=5000,
        description="Number of nodes in the graph, and of pairs whose points are kept.",
    )
    matching: ScanMatchingSettings = Field(
        ScanMatchingSettings(), description="Matching of a pair to the pairs before it."
    )
    odometry: OdometryNoiseSettings = Field(
        OdometryNoiseSettings(), description="Noise of the state estimate."
    )


class VoxelMapSettings(MapSettings):
    """Extent and resolution of the map, and when it forgets."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)

    forget_after: int = Field(
        3,
        ge=0,
        le=100,
        description="Scan pairs in a row that see through a place until it is forgotten; 0: never.",
    )
    seen_through_m: Meters = Field(
        0.3,
        gt=0,
        le=5,
        description="Distance behind a place at which a ray must end to have passed through it "
        "[m].",
    )
    smallest_m: Meters = Field(
        0.25,
        gt=0,
        le=5,
        description="Width of the smallest thing that is kept where rays pass on both sides of it "
        "[m].",
    )
    standing_after: int = Field(
        20,
        ge=1,
        le=1000,
        description="Scan pairs after which what came into a place that was seen to be empty "
        "stands there; until then it moves. 2 s at 10 Hz: slower than half of its own width in "
        "that time, a thing stands.",
    )
