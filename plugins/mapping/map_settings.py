"""What all maps of voxels are told."""

from pydantic import Field

from executive.config import Meters, Seconds, Settings


class MapSettings(Settings):
    """Extent and grain of a map, and what of a scan it leaves out."""

    voxel_m: Meters = Field(0.03, gt=0, le=1, description="Edge of a voxel, res_voxel [m].")
    min_points: int = Field(2, ge=1, description="Returns that make a voxel occupied, n_min.")
    radius_m: Meters = Field(
        10.0, gt=0, description="Radius of the mapped cylinder around the cabin, R_map [m]."
    )
    padding_m: Meters = Field(
        0.10, ge=0, le=1, description="Returns this near to a link are the machine's [m]."
    )
    shadow_m: Meters = Field(
        0.02,
        ge=0,
        le=1,
        description="Returns whose ray passes a link at this distance are dropped; 0: none [m].",
    )
    nearest_m: Meters = Field(0.6, ge=0, description="Nearer returns are dropped [m].")
    slice_s: Seconds = Field(
        0.01, gt=0, description="Time over which joints are taken as still [s]."
    )
    smoothing_m: Meters = Field(
        0.045, ge=0, le=1, description="Reach over which range noise is averaged; 0: none [m]."
    )
    memory: int = Field(100, ge=1, description="Returns over which a voxel's mean is taken.")
