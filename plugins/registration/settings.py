"""Settings of the registration plugins, apart from them: reading a mission imports no algorithm."""

from enum import StrEnum
from typing import Any, ClassVar

from pydantic import Field, model_validator

from executive.config import Meters
from executive.interfaces.declaration import PluginSettings


class Preset(StrEnum):
    """Named radii."""

    SURE = "sure"
    PAPER = "paper"


# The paper's Table 3 gives R_iss and R_shot; its points are those of the map.
_RADII = {
    Preset.SURE: {
        "feature_voxel_m": 0.05,
        "iss_radius_m": 0.12,
        "keypoint_gap_m": 0.08,
        "shot_radius_m": 0.40,
    },
    Preset.PAPER: {
        "feature_voxel_m": 0.03,
        "iss_radius_m": 0.06,
        "keypoint_gap_m": 0.04,
        "shot_radius_m": 0.10,
    },
}


class SegmentSettings(PluginSettings):
    """Settings of the search, the refinement and the acceptance."""

    voxel_m: Meters = Field(
        0.03, gt=0, description="Grid to which the source is thinned, that of the map [m]."
    )
    consistency_m: Meters = Field(
        0.08, gt=0, description="Allowed difference of two matches' distances [m]."
    )
    candidates: int = Field(
        10, ge=1, le=100, description="Most candidate motions of each method, b."
    )
    pair_tolerance_m: Meters = Field(
        0.5, gt=0, description="Allowed difference of two centroids' distances [m]."
    )
    max_match_m: Meters = Field(
        1.0, gt=0, description="Largest distance of matched centroids, d_match [m]."
    )
    max_scale_error: float = Field(
        0.03, ge=0, le=0.2, description="Largest error of the source's scale, as a share."
    )
    coarse_reach_m: Meters = Field(
        0.5, gt=0, description="Largest distance of correspondences at a candidate [m]."
    )
    fine_voxel_m: Meters = Field(
        0.08, gt=0, description="Grid of the stones' points for the refinement [m]."
    )
    ground_voxel_m: Meters = Field(
        0.25, gt=0, description="Grid of the ground's points for the refinement [m]."
    )
    truncation_m: Meters = Field(
        0.10, gt=0, description="Distance beyond which points do not overlap [m]."
    )
    max_rmse_m: Meters = Field(
        0.04, gt=0, description="Largest accepted RMSE of overlapping points [m]."
    )
    min_overlap: float = Field(
        0.6, ge=0, le=1, description="Smallest accepted share of points that overlap."
    )
    min_matched: int = Field(
        3, ge=1, description="Fewest stones that must agree; with fewer in view it is refused."
    )
    bend_m: Meters = Field(
        0.01,
        ge=0,
        le=1,
        description="Standard deviation of a survey's smooth bends, for the covariance [m].",
    )
    max_wrong_probability: float = Field(
        1e-4,
        ge=0,
        le=1,
        description="Largest probability that one of the other motions that were tried is the true "
        "one, at which the best is accepted.",
    )


class KissMatcherSettings(SegmentSettings):
    """Resolution of the features, and the gate."""

    needs: ClassVar[tuple[str, ...]] = ("segmentation", "alignment")

    feature_voxel_m: Meters = Field(
        0.10, gt=0, description="Grid to which the matcher thins segments [m]."
    )


class SegmentFpfhSettings(SegmentSettings):
    """Radii of the features, sizes of the search, and the gate."""

    needs: ClassVar[tuple[str, ...]] = ("segmentation", "alignment")

    feature_voxel_m: Meters = Field(
        0.06, gt=0, description="Grid of the points that shape features [m]."
    )
    iss_radius_m: Meters = Field(0.15, gt=0, description="Salient radius of keypoints, R_iss [m].")
    fpfh_radius_m: Meters = Field(0.50, gt=0, description="Radius of descriptors [m].")
    nearest: int = Field(
        2, ge=1, le=10, description="Target keypoints that each source keypoint is matched with."
    )


class SegmentShotSettings(SegmentSettings):
    """Radii of the features, sizes of the search, and the gate."""

    needs: ClassVar[tuple[str, ...]] = ("segmentation", "alignment")

    preset: Preset = Field(
        Preset.SURE, description="Radii unless given one by one: sure, or the paper's."
    )
    feature_voxel_m: Meters = Field(
        0.05, gt=0, description="Grid of the points that shape features [m]."
    )
    iss_radius_m: Meters = Field(
        0.12, gt=0, description="Salient radius of keypoints and normals, R_iss [m]."
    )
    keypoint_gap_m: Meters = Field(
        0.08, gt=0, description="A keypoint stands out among points this near [m]."
    )
    shot_radius_m: Meters = Field(0.40, gt=0, description="Radius of descriptors, R_shot [m].")
    max_matches: int = Field(
        600, ge=10, le=5000, description="Most matches that are looked at, the most alike."
    )
    falls_back: bool = Field(
        True,
        description="Whether the arrangement of the stones is tried first, and SHOT where that is "
        "refused.",
    )

    @model_validator(mode="before")
    @classmethod
    def _fill_in_radii(cls, given: Any) -> Any:
        preset = given.get("preset") if isinstance(given, dict) else None
        if isinstance(preset, str) and preset in set(Preset):
            return {**_RADII[Preset(preset)], **given}
        return given
