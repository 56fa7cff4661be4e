"""Grasps in the order of the paper, with simulated lifts, without a classifier (Mascaro 2020)."""

from typing import ClassVar

import numpy as np
from executive_plugins.grasping.sampled_planner import Order, SampledPlanner
from executive_plugins.grasping.sampling.planning_cloud import PlanningCloud
from executive_plugins.grasping.sampling.pool import Pool
from executive_plugins.grasping.settings import SampledAntipodalSettings

from executive.config import Settings
from executive.interfaces.motion import MotionPlanner
from executive.machine.machine import Machine


class SampledAntipodal(SampledPlanner):
    """Samples approaches on the stone and straight down onto it.

    It keeps the grasps that hold the stone, collide with nothing and are in reach.
    """

    Settings: ClassVar[type[Settings]] = SampledAntipodalSettings

    def __init__(
        self, settings: SampledAntipodalSettings, machine: Machine, motion: MotionPlanner
    ) -> None:
        super().__init__(settings, machine, motion)

    def ordered(self, scene: PlanningCloud, pool: Pool) -> Order:
        """Return the order of the paper (Sec. 5.4).

        The value of a grasp is unknown before its simulated lift.
        """
        return Order(self.paper_order(pool), np.zeros(len(pool)), {}, is_telling=False)
