"""Settings of the monitoring plugins, apart from them: reading a mission imports no algorithm."""

from typing import ClassVar

from pydantic import Field

from executive.config import Meters, Seconds
from executive.interfaces.declaration import PluginSettings


class HoldStateSettings(PluginSettings):
    """What counts as trouble with a held stone. All lengths are openings between the tips."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)

    slip: Meters = Field(
        0.015,
        gt=0,
        le=0.5,
        description="Motion of the jaws within the window that counts as slip or opening [m].",
    )
    window: Seconds = Field(
        5.0, gt=0, le=60, description="Length of the window; slower closing counts as settling [s]."
    )
    creep: Meters = Field(
        0.06,
        gt=0,
        le=0.5,
        description="Closing since the stone has settled that counts as slip [m].",
    )
    lift_settle: Seconds = Field(
        3.0,
        ge=0,
        le=30,
        description="Time in which the stone settles after the arm first moves [s]; it ends "
        "earlier once `TrialLift` has found that the stone hangs.",
    )
    lift_slip: Meters = Field(
        0.3, gt=0, le=1, description="Closing that counts as slip before the stone has settled [m]."
    )
    empty: Meters = Field(
        0.1, ge=0, le=1, description="Opening below which the jaws hold nothing [m]."
    )
    probability: float = Field(
        0.99,
        gt=0.5,
        lt=1,
        description="Probability of trouble from which it is reported, once it lasts.",
    )


class JawSlipSettings(HoldStateSettings):
    """What counts as trouble with a held stone; slips are reported."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)


class PayloadDropSettings(HoldStateSettings):
    """What counts as trouble with a held stone; falls are reported."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)
