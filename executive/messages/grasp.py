"""Grasps of a stone."""

from collections.abc import Mapping
from dataclasses import dataclass

from executive.arrays import Float, checked


@dataclass(frozen=True, slots=True, eq=False)
class Grasp:
    """A pose of the gripper in which its jaws can close on a stone.

    The gripper's frame: origin at the palm's centre, x out of the palm (the approach), y from jaw
    to jaw, z along the jaws' width.

    Attributes:
        T_map_gripper: Pose of the gripper with its jaws open around the stone, shape (4, 4).
        opening_m: Distance of the open tips [m].
        score: Higher is better; only comparable within one plan.
        costs: The terms of the score by name: `align_rad`, `enclose_m`, `distance_m` (Mascaro 2020,
            Eq. 5–7), and others.
        hold_rate: The share of lifts with this grasp that are expected to hold, 0 to 1, from
            rehearsals and predictions; None if nothing tells it.
    """

    T_map_gripper: Float
    opening_m: float
    score: float
    costs: Mapping[str, float]
    hold_rate: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(
            self, "T_map_gripper", checked("T_map_gripper", self.T_map_gripper, 4, 4)
        )
        if self.hold_rate is not None and not 0.0 <= self.hold_rate <= 1.0:
            raise ValueError(f"hold_rate is a share from 0 to 1, got {self.hold_rate}")


@dataclass(frozen=True, slots=True, eq=False)
class GraspPlan:
    """Grasps, best first, and why the other hypotheses were refused.

    Attributes:
        grasps: Best first; empty if the stone cannot be grasped.
        refused: Number of hypotheses by reason, such as `palm_in_ground`.
        is_final: Whether another plan for the same stone would refuse it too, because it is too
            heavy or too large for the machine: then nothing retries it.
        detail: The measured figures behind a refusal, in words.
    """

    grasps: tuple[Grasp, ...]
    refused: Mapping[str, int]
    is_final: bool = False
    detail: str = ""
