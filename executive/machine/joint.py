"""The joints of the arm, and the joint that drives the jaws."""

import math
from typing import Literal

import numpy as np
from pydantic import Field, model_validator

from executive.arrays import Float
from executive.machine.origin import Origin, Vec3
from executive.machine.provenance import Sourced


class JointLimits(Sourced):
    """Limits of a joint's motion and effort, in rad for revolute and m for prismatic joints."""

    max_velocity: float = Field(gt=0, description="Largest speed [rad/s] or [m/s].")
    max_acceleration: float = Field(gt=0, description="Largest acceleration [rad/s²] or [m/s²].")
    max_jerk: float = Field(gt=0, description="Largest jerk [rad/s³] or [m/s³].")
    max_effort: float = Field(gt=0, description="Largest torque [N·m] or force [N].")


class Joint(JointLimits, Origin):
    """One joint of the chain from the base to the gripper."""

    name: str = Field(description="Unique name.")
    kind: Literal["revolute", "continuous", "prismatic"] = Field(description="Kind of motion.")
    parent: str = Field(description="Link that carries it.")
    child: str = Field(description="Link that it moves, whose frame is the joint's frame.")
    axis: Vec3 = Field(description="Unit axis in the joint's frame.")
    range: tuple[float, float] | None = Field(
        None, description="Lower and upper limit [rad] or [m]; none if continuous."
    )
    loaded_max_velocity: float | None = Field(
        None, gt=0, description="Speed with a load, if lower."
    )
    loaded_max_acceleration: float | None = Field(
        None, gt=0, description="Acceleration with a load, if lower."
    )
    holds_without_pressure: bool = Field(
        False,
        description="Whether a valve at its cylinder, or a brake, stops and holds it when its line"
        " loses pressure.",
    )

    @model_validator(mode="after")
    def _check(self) -> "Joint":
        if (self.kind == "continuous") != (self.range is None):
            raise ValueError("a continuous joint has no range, and any other joint has one")
        if self.range is not None and self.range[0] >= self.range[1]:
            raise ValueError(f"range must rise, got {list(self.range)}")
        if not math.isclose(float(np.linalg.norm(self.axis)), 1.0, abs_tol=1e-9):
            raise ValueError(f"axis must have length 1, got {list(self.axis)}")
        return self

    @property
    def lower(self) -> float:
        """Lower end [rad] or [m]; −inf if continuous."""
        return -math.inf if self.range is None else self.range[0]

    @property
    def upper(self) -> float:
        """Upper end [rad] or [m]; inf if continuous."""
        return math.inf if self.range is None else self.range[1]

    @property
    def T_parent_joint(self) -> Float:
        """Pose of the joint at zero in its parent link, shape (4, 4)."""
        return self.T


class Jaw(JointLimits):
    """The actuated joint of the left jaw; the right jaw mirrors it. Angle 0 is closed."""

    name: str = Field(description="Unique name.")
    open_rad: float = Field(gt=0, lt=math.pi, description="Angle of the widest opening [rad].")

    @property
    def lower(self) -> float:
        """Closed [rad]."""
        return 0.0

    @property
    def upper(self) -> float:
        """Widest opening [rad]."""
        return self.open_rad

    @property
    def mirror_name(self) -> str:
        """Name of the passive joint of the right jaw."""
        return f"{self.name}_MIRROR"
