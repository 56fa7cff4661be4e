"""Settings of the segmentation plugins, apart from them: reading a mission imports no algorithm."""

from typing import ClassVar

import numpy as np
from pydantic import Field

from executive.config import Meters, Radians
from executive.interfaces.declaration import PluginSettings


class GroundAndClustersSettings(PluginSettings):
    """Limits between ground and objects, and between objects."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)

    foot_level_m: Meters = Field(
        0.03, ge=0, le=1, description="Points lower than this above the ground are ground [m]."
    )
    foot_reach_m: Meters = Field(
        0.1,
        ge=0,
        le=1,
        description="Points between the two heights belong to the foot of an object whose points "
        "are so near [m]; 0 leaves feet out.",
    )
    plane_margin_m: Meters = Field(
        0.10, gt=0, le=1, description="Height up to which points are ground, d_plane [m]."
    )
    max_tilt_rad: Radians = Field(
        np.pi / 6, gt=0, lt=np.pi / 2, description="Ground's largest angle to level [rad]."
    )
    node_m: Meters = Field(
        0.5, ge=0.2, le=5, description="Distance of the terrain grid's nodes [m]."
    )
    max_rise_rad: Radians = Field(
        np.pi / 9,
        gt=0,
        lt=np.pi / 2,
        description="Ground's steepest slope against its mean plane: steeper sides are those of "
        "stones [rad].",
    )
    stiffness: float = Field(
        0.5, gt=0, description="Bending of the terrain grid against a cell full of points."
    )
    voxel_m: Meters = Field(
        0.07, gt=0, le=1, description="Grid edge of the clustering; smaller gaps are bridged [m]."
    )
    fine_voxel_m: Meters = Field(
        0.04, gt=0, le=1, description="Grid edge on which neighbours are parted [m]."
    )
    cell_m: Meters = Field(0.05, gt=0, le=1, description="Grid edge of the view from above [m].")
    valley_depth: float = Field(
        0.3, gt=0, le=1, description="Drop from a stone's top to the next, as a share."
    )
    core_share: float = Field(
        0.85, gt=0, le=1, description="Share of a cluster that its parts must hold to split it."
    )
    patch_m: Meters = Field(
        0.12, gt=0, le=1, description="Grid edge of compared patches, four voxels of a map [m]."
    )
    concave_rad: Radians = Field(
        0.1, ge=0, lt=np.pi / 2, description="Angle by which one stone may be concave [rad]."
    )
    max_hollow: float = Field(
        0.08,
        gt=0,
        le=1,
        description="Depth of one stone's hollows under its convex hull, in its longest side.",
    )
    min_points: int = Field(60, ge=10, description="Fewest points of an object.")
    min_extent_m: Meters | None = Field(
        None,
        gt=0,
        description="A stone's longest side is at least this; by default what the jaws hold [m].",
    )
    max_extent_m: Meters | None = Field(
        None,
        gt=0,
        description="A stone's longest side is at most this; by default what the arm lifts [m].",
    )
    min_height_m: Meters | None = Field(
        None,
        gt=0,
        description="A stone rises at least this far above the ground; by default plane_margin_m "
        "and two flat_margin_m [m].",
    )
    flat_margin_m: Meters = Field(
        0.03, gt=0, description="Distance from a plane that still is the plane [m]."
    )
    flat_share: float = Field(
        0.85, gt=0, le=1, description="Share of points on one plane above which it is no object."
    )
    merged_voxel_m: Meters = Field(
        0.03, gt=0, le=1, description="Grid edge to which merged clouds are thinned [m]."
    )
    seed: int = Field(0, ge=0, description="Seed of the random samples.")


class GroundAndPartsSettings(GroundAndClustersSettings):
    """Limits between ground and objects, and how concave a stone may be."""
