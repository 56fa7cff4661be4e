"""Settings of the monitoring plugins, apart from them: reading a mission imports no algorithm."""

from typing import ClassVar

from pydantic import Field

from executive.config import Kilograms, Meters, Seconds
from executive.interfaces.declaration import PluginSettings


class JawSlipSettings(PluginSettings):
    """When closing jaws count as slip. All lengths are openings between the tips."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)

    slip: Meters = Field(
        0.015, gt=0, le=0.5, description="Closing within the window that counts as slip [m]."
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
        description="Time in which the stone settles after the arm first moves [s].",
    )
    lift_slip: Meters = Field(
        0.3, gt=0, le=1, description="Closing that counts as slip before the stone has settled [m]."
    )
    empty: Meters = Field(
        0.1, ge=0, le=1, description="Opening below which the jaws hold nothing [m]."
    )
    confirm: Seconds = Field(
        0.25, ge=0, le=5, description="Time for which trouble must last before it is reported [s]."
    )


class PayloadDropSettings(PluginSettings):
    """When a loss of weight counts as a drop."""

    needs: ClassVar[tuple[str, ...]] = ("machine",)

    smoothing: Seconds = Field(
        0.3, gt=0, le=5, description="Time constant of the estimated mass [s]."
    )
    carried: Kilograms = Field(
        250.0, gt=0, description="Mass from which a stone counts as carried [kg]."
    )
    loss: float = Field(
        0.5, gt=0, lt=1, description="Share of the carried mass whose loss counts as a drop."
    )
    sudden: Seconds = Field(
        3.0, gt=0, le=60, description="A loss within this time counts as sudden [s]."
    )
    confirm: Seconds = Field(
        0.4, ge=0, le=5, description="Time for which the loss must last before it is reported [s]."
    )
    steady: float = Field(
        0.6,
        gt=0,
        le=5,
        description="Share of the acceleration limits up to which the mass is estimated.",
    )
    touch_down: Seconds = Field(
        3.0,
        ge=0,
        le=60,
        description="Time after sinking in which the ground may carry the stone [s].",
    )
    jaw_closing: Meters = Field(
        0.05, gt=0, le=1, description="Closing of the tips that shows a drop during set-down [m]."
    )
