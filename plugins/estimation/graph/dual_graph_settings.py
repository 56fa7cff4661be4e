"""Settings of the dual graph."""

from executive_plugins.estimation.cabin.settings import CabinSettings
from executive_plugins.estimation.graph.smoother_settings import SmootherSettings
from pydantic import Field

from executive.config import Seconds


class DualGraphSettings(CabinSettings):
    """Settings of the estimator: those of all, and where and how it smooths."""

    process: bool = Field(
        False,
        description="Whether to smooth in a process of its own; false gives the same result on "
        "each run.",
    )
    answer_within_s: Seconds = Field(
        1.0,
        gt=0.05,
        le=60,
        description="A smoother's process that is silent for so long is replaced [s].",
    )
    smoother: SmootherSettings = Field(
        default_factory=SmootherSettings, description="The graphs and the gate."
    )
