"""Settings of the alignment plugins, apart from them: reading a mission imports no algorithm."""

from pydantic import Field

from executive.config import Meters
from executive.interfaces.declaration import PluginSettings


class AlignmentSettings(PluginSettings):
    """Resolution and acceptance of an alignment."""

    voxel_m: Meters = Field(
        0.05, gt=0, le=1, description="Grid to which both clouds are thinned [m]."
    )
    neighbours: int = Field(
        12, ge=5, le=50, description="Points that shape a surface's normal or covariance."
    )
    max_iterations: int = Field(40, ge=1, description="Most steps of the optimisation.")
    min_points: int = Field(20, ge=6, description="Fewer points of either cloud are refused.")
    gate_distance_m: Meters = Field(
        0.10, gt=0, description="Distance up to which points count as overlapping [m]."
    )
    max_rmse_m: Meters = Field(
        0.04, gt=0, description="Largest accepted distance of overlapping points [m]."
    )
    discount_gaps: bool = Field(
        False,
        description="Whether distances along the surface count towards max_rmse_m only as far as a "
        "target as dense as the grid would have them, whatever the distance of its points. A "
        "target that is sparse in places is accepted then; a stone that is half seen is, too, "
        "although it lies a few degrees off.",
    )
    min_overlap: float = Field(
        0.4, ge=0, le=1, description="Smallest accepted share of source points that overlap."
    )


class GicpSettings(AlignmentSettings):
    """Resolution and acceptance of an alignment."""


class PointToPlaneSettings(AlignmentSettings):
    """Resolution and acceptance of an alignment."""
