"""Settings that all registrations on segments share: search, refinement, acceptance."""

from pydantic import Field

from executive.config import Meters, Settings


class SegmentSettings(Settings):
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
        0.16, gt=0, description="Grid of the ground's points for the refinement [m]."
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
