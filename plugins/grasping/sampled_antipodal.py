"""Grasps without a classifier: in the paper's order, the best of them rehearsed (Mascaro 2020, Sec.
5).
"""

from typing import ClassVar

import numpy as np
from executive_plugins.grasping.sampled_planner import Order, SampledPlanner, SampledPlannerSettings
from executive_plugins.grasping.sampling.planning_cloud import PlanningCloud
from executive_plugins.grasping.sampling.pool import Pool

from executive.config import Settings
from executive.interfaces.motion import MotionPlanner
from executive.machine.machine import Machine


class SampledAntipodalSettings(SampledPlannerSettings):
    """Sampling, the paper's stages, reach and rehearsal."""


class SampledAntipodal(SampledPlanner):
    """Samples approaches on the stone, and straight down onto it; keeps what holds it, hits nothing
    and is in reach.
    """

    Settings: ClassVar[type[Settings]] = SampledAntipodalSettings

    def __init__(
        self, settings: SampledAntipodalSettings, machine: Machine, motion: MotionPlanner
    ) -> None:
        super().__init__(settings, machine, motion)

    def ordered(self, scene: PlanningCloud, pool: Pool) -> Order:
        """Return the paper's order (Sec. 5.4); nothing tells what a grasp is worth before it is
        rehearsed.
        """
        return Order(self.paper_order(pool), np.zeros(len(pool)), {}, is_telling=False)
