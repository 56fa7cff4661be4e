"""Settings of the grasping plugins, apart from them: reading a mission imports no algorithm."""

from typing import ClassVar, Literal

from executive_plugins.grasping.sampling.settings import SamplingSettings
from executive_plugins.physics.belief import Assumed
from pydantic import Field, field_validator, model_validator

from executive.config import Meters, Radians


class SampledPlannerSettings(SamplingSettings):
    """Sampling, the stages of the paper, reach and simulated lifts."""

    approach_m: Meters = Field(
        0.8, ge=0, description="Length of the straight descent to a grasp, free and in reach [m]."
    )
    overload: float = Field(
        1.25,
        ge=1,
        description="Refused ratio of the mass by the volume of a hull to the payload; a hull is "
        "larger than its stone by 13 ± 6 %, so that 1.25 is one that is too heavy by 95 %.",
    )
    lift_capacity: Literal["by_base", "payload", "iso_10567"] = Field(
        "by_base",
        description="What limits a lift: the payload and the efforts of the joints; or also the "
        "rated lift capacity by radius and side, which tipping limits (ISO 10567); by_base is the "
        "latter where the machine may tip.",
    )
    keep_aligned: int = Field(
        40, ge=1, description="Number of grasps that pass the ranking by alignment (Sec. 5.4)."
    )
    keep_enclosing: int = Field(
        20, ge=1, description="Number of grasps that pass the ranking by enclosing (Sec. 5.4)."
    )
    rehearsed: int = Field(
        32,
        ge=0,
        le=500,
        description="Largest number of grasps that are lifted in simulation; with 0 none is, and "
        "the order is kept.",
    )
    physics: Assumed = Field(
        "wet_to_dry",
        description="Contacts that simulated lifts assume: those of a scenario of the simulator, "
        "whatever the world has; wet_to_dry has the friction of wet to dry stones.",
    )
    steel_friction: tuple[float, float] | None = Field(
        None,
        description="Least and largest friction of steel on stone that simulated lifts assume; by "
        "`physics` if not given.",
    )
    arm_error_m: Meters = Field(
        0.02,
        ge=0,
        le=0.2,
        description="Largest error of the gripper's place along each axis that simulated lifts "
        "assume [m]: that of the arm, and of the map. `kind` assumes its own.",
    )
    arm_error_rad: Radians = Field(
        0.026,
        ge=0,
        le=0.5,
        description="The same of the gripper's attitude about each axis [rad].",
    )
    max_slip_m: Meters = Field(
        0.3,
        gt=0,
        description="Slip in simulated lifts, and a fifth of the drag by the closing jaws, above "
        "which a grasp is refused [m]. A fallen stone counts 0.5 m: from there on none is.",
    )
    max_grasps: int = Field(8, ge=1, description="Largest number of grasps returned.")

    @field_validator("steel_friction")
    @classmethod
    def _check_friction(cls, given: tuple[float, float] | None) -> tuple[float, float] | None:
        if given is not None and not 0.05 <= given[0] <= given[1] <= 2:
            raise ValueError(f"expected [least, largest] within 0.05 to 2, got {list(given)}")
        return given

    @model_validator(mode="after")
    def _check_scale(self) -> "SampledPlannerSettings":
        if self.scale != 1 and self.rehearsed:
            raise ValueError(
                "simulated lifts support machines of full size only: with a scale, set rehearsed: 0"
            )
        return self


class SampledAntipodalSettings(SampledPlannerSettings):
    """Sampling, the stages of the paper, reach and simulated lifts."""

    needs: ClassVar[tuple[str, ...]] = ("machine", "motion")


class SampledCnnSettings(SampledPlannerSettings):
    """The network, and how its predictions are used."""

    needs: ClassVar[tuple[str, ...]] = ("machine", "motion")

    weights: str = Field(
        "two_stream",
        description="Shipped weights, or a safetensors file: two_stream, of lifts in `nominal`; "
        "two_stream_kind or four_layer, of lifts in `kind`.",
    )
    ranking: Literal["learned", "paper"] = Field(
        "learned",
        description="learned: by predicted success; paper: stages among likely successes.",
    )
    min_success: float = Field(
        0.5, ge=0, le=1, description="Least predicted success for the ranking 'paper'."
    )
    min_score: float = Field(
        0.0,
        ge=-1,
        le=1,
        description="Least score for the ranking 'learned', where it is the predicted success less "
        "the share of a fall in simulated lifts; a grasp below it is refused as unlikely.",
    )
    rehearsed: int = Field(
        12,
        ge=0,
        le=500,
        description="Largest number of grasps that are lifted in simulation; 0 for none.",
    )
