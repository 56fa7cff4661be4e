"""Settings of the objects plugins, apart from them: reading a mission imports no algorithm."""

from pydantic import Field

from executive.config import Meters
from executive.interfaces.declaration import PluginSettings


class SqliteObjectsSettings(PluginSettings):
    """When a segment is a known stone, when its surface grows, and the resolution of surfaces."""

    max_distance_m: Meters = Field(
        0.6, gt=0, description="Largest distance of a segment from its stone [m]."
    )
    max_roll_m: Meters = Field(
        3.0, gt=0, description="The same for a stone that was dropped or lost [m]."
    )
    max_growth: float = Field(
        1.6, gt=1, description="Largest ratio of the box diagonals of segment and stone."
    )
    max_growth_whole: float = Field(
        1.15, gt=1, description="The same for a stone that was seen from above before."
    )
    voxel_m: Meters = Field(0.03, gt=0, description="Grid to which surfaces are thinned [m].")
    max_points: int = Field(
        20_000,
        ge=100,
        description="Largest number of points of a surface; a coarser grid keeps it.",
    )
    agreement_m: Meters = Field(
        0.10, gt=0, description="Distance up to which points of two surfaces agree [m]."
    )
    min_agreement: float = Field(
        0.6, ge=0, le=1, description="Share of points that must agree before a surface grows."
    )
    max_rmse_m: Meters = Field(
        0.04, gt=0, description="Largest root mean square distance of surfaces that agree [m]."
    )
    explained_m: Meters = Field(
        0.08, gt=0, description="A map point this near to a stone's model is of that stone [m]."
    )
    ground_m: Meters = Field(
        0.10, ge=0, description="Map points this low on a stone's model are kept as ground [m]."
    )
