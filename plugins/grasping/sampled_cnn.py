"""Grasps ranked by a network that was trained on simulated lifts (for Mascaro 2020, Sec. 5.4).

torch is imported when a planner starts, not with this file: checking a mission is then two seconds
faster.
"""

from collections.abc import Iterator
from typing import Any, ClassVar

import numpy as np
from executive_plugins.grasping.classifier.grasp_features import features_of
from executive_plugins.grasping.classifier.grasp_images import draw_images, image_cube
from executive_plugins.grasping.classifier.weights_file import weights_file
from executive_plugins.grasping.sampled_planner import Order, SampledPlanner
from executive_plugins.grasping.sampling.planning_cloud import PlanningCloud
from executive_plugins.grasping.sampling.pool import Pool
from executive_plugins.grasping.settings import SampledCnnSettings

from executive.arrays import Bool
from executive.config import Settings
from executive.interfaces.motion import MotionPlanner
from executive.machine.machine import Machine


class SampledCnn(SampledPlanner):
    """Samples like `sampled_antipodal`, and ranks by the success that a network predicts."""

    Settings: ClassVar[type[Settings]] = SampledCnnSettings
    late_imports = ("executive_plugins.grasping.classifier.outcome_net",)  # imports torch

    def __init__(
        self, settings: SampledCnnSettings, machine: Machine, motion: MotionPlanner
    ) -> None:
        super().__init__(settings, machine, motion)
        self._judging = settings
        self._net: Any = None

    def start(self) -> None:
        """Load the weights, tabulate the gripper and compile the loops.

        Raises:
            DataError: If the weights file cannot be used.
        """
        self._loaded()
        super().start()
        none, axes = np.zeros((1, 3)), np.eye(3)[None]
        draw_images(
            none, np.ones(1, dtype=bool), none, axes, none, image_cube(self._machine.gripper)
        )  # compiles the loops

    def ordered(self, scene: PlanningCloud, pool: Pool) -> Order:
        """Return the pool by predicted success, or likely successes in the order of the paper."""
        from executive_plugins.grasping.classifier.outcome_net import success

        likely = success(self._loaded(), features_of(scene, pool, self._machine.gripper))
        by_success = (int(i) for i in np.argsort(-likely, kind="stable"))
        is_paper = self._judging.ranking == "paper"
        order = (
            self._paper_first(pool, likely >= self._judging.min_success, by_success)
            if is_paper
            else by_success
        )
        costs = {"failure": 1.0 - likely}
        if is_paper:
            return Order(order, np.zeros(len(pool)), costs, is_telling=False)
        return Order(order, likely, costs, True, self._judging.min_score)

    def _paper_first(
        self, pool: Pool, is_accepted: Bool, by_success: Iterator[int]
    ) -> Iterator[int]:
        """Yield the accepted grasps in the order of the paper, then the others by success."""
        accepted = np.flatnonzero(is_accepted)
        yield from (int(accepted[i]) for i in self.paper_order(pool.taken(accepted)))
        yield from (i for i in by_success if not is_accepted[i])

    def _loaded(self) -> Any:
        """Return the network, a `FourLayer` or a `TwoStream`; load it at the first call."""
        from executive_plugins.grasping.classifier.outcome_net import load_net

        if self._net is None:
            self._net = load_net(weights_file(self._judging.weights))
        return self._net
