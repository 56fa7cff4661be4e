"""Grasps ranked by a network that has learned from physical lifts which succeed (for Mascaro 2020,
Sec. 5.4).

torch is imported when a planner starts, not with this file: a mission is checked in two seconds
less.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
from executive_plugins.grasping.classifier.grasp_features import features_of
from executive_plugins.grasping.classifier.grasp_images import draw_images, image_cube
from executive_plugins.grasping.sampled_planner import Order, SampledPlanner, SampledPlannerSettings
from executive_plugins.grasping.sampling.planning_cloud import PlanningCloud
from executive_plugins.grasping.sampling.pool import Pool
from pydantic import Field

from executive.arrays import Bool
from executive.config import Meters, Settings
from executive.interfaces.motion import MotionPlanner
from executive.machine.machine import Machine

_SHIPPED = Path(__file__).parent / "weights"


def weights_file(name: str) -> Path:
    """Return the file of shipped weights by their name, or else the path that the name is."""
    shipped = _SHIPPED / f"m545_{name}.safetensors"
    return shipped if shipped.exists() else Path(name)


class SampledCnnSettings(SampledPlannerSettings):
    """Which network judges, and how its judgement is used."""

    weights: str = Field(
        "two_stream", description="two_stream or four_layer as shipped, or a safetensors file."
    )
    ranking: Literal["learned", "paper"] = Field(
        "learned",
        description="By predicted success, or the paper's stages on what is predicted to succeed.",
    )
    min_success: float = Field(
        0.5, ge=0, le=1, description="Predicted success that the paper's ranking asks for."
    )
    rehearsed: int = Field(
        8, ge=0, le=500, description="Most grasps that are rehearsed on top; 0 for none."
    )
    max_slip_m: Meters = Field(
        1.0, gt=0, description="A grasp whose stone moves more in rehearsals is refused [m]."
    )


class SampledCnn(SampledPlanner):
    """Samples as `sampled_antipodal` does, and ranks by the success that a network predicts from
    grasp images.
    """

    Settings: ClassVar[type[Settings]] = SampledCnnSettings

    def __init__(
        self, settings: SampledCnnSettings, machine: Machine, motion: MotionPlanner
    ) -> None:
        super().__init__(settings, machine, motion)
        self._judging = settings
        self._net: Any = None

    def start(self) -> None:
        """Read the weights, and prepare what plans need.

        Raises:
            DataError: If the file cannot be used.
        """
        self._loaded()
        super().start()
        none, axes = np.zeros((1, 3)), np.eye(3)[None]
        draw_images(
            none, np.ones(1, dtype=bool), none, axes, none, image_cube(self._machine.gripper)
        )  # compiles

    def ordered(self, scene: PlanningCloud, pool: Pool) -> Order:
        """Return the pool by predicted success, or by the paper's stages on what is predicted to
        succeed.
        """
        from executive_plugins.grasping.classifier.outcome_net import success

        likely = success(self._loaded(), features_of(scene, pool, self._machine.gripper))
        by_success = (int(i) for i in np.argsort(-likely, kind="stable"))
        is_paper = self._judging.ranking == "paper"
        order = (
            self._paper_first(pool, likely >= self._judging.min_success, by_success)
            if is_paper
            else by_success
        )
        worth = np.zeros(len(pool)) if is_paper else likely
        return Order(order, worth, {"failure": 1.0 - likely}, is_telling=not is_paper)

    def _paper_first(
        self, pool: Pool, is_accepted: Bool, by_success: Iterator[int]
    ) -> Iterator[int]:
        """Yield what is accepted in the paper's order; then the others, the likeliest first."""
        accepted = np.flatnonzero(is_accepted)
        yield from (int(accepted[i]) for i in self.paper_order(pool.taken(accepted)))
        yield from (i for i in by_success if not is_accepted[i])

    def _loaded(self) -> Any:
        """Return the network, a `FourLayer` or a `TwoStream`."""
        from executive_plugins.grasping.classifier.outcome_net import load_net

        if self._net is None:
            self._net = load_net(weights_file(self._judging.weights))
        return self._net
