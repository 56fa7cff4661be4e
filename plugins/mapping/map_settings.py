"""Settings that all maps of voxels share."""

from pydantic import Field

from executive.config import Meters, Seconds, Settings


class MapSettings(Settings):
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
