"""Settings of the viewing plugins, apart from them: reading a mission imports no algorithm."""

from typing import ClassVar

from pydantic import Field

from executive.config import Seconds
from executive.interfaces.declaration import PluginSettings


class RerunSettings(PluginSettings):
    """Settings of the recording."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)

    machine_period_s: Seconds = Field(
        0.1, gt=0, le=10, description="Time between two drawings of the machine [s]."
    )
    max_points: int = Field(
        120_000, ge=1000, description="Largest number of points drawn of one cloud."
    )
    batch_period_s: Seconds = Field(
        10.0,
        gt=0,
        le=60,
        description="Time on the wall for which rows are gathered before they are written together "
        "[s]: as much of a recording is lost when the run is killed.",
    )
    live_period_s: Seconds = Field(
        1.0,
        gt=0,
        le=10,
        description="The same of a mission that is shown live [s]: as late it is shown.",
    )
