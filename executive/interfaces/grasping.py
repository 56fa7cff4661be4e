"""Grasp planning: a stone and its surroundings to ways to hold it."""

from abc import ABC, abstractmethod

import numpy as np

from executive.arrays import Float
from executive.interfaces.plugin import Plugin
from executive.messages.cloud import Cloud
from executive.messages.grasp import GraspPlan
from executive.messages.stone import Stone


class GraspPlanner(Plugin, ABC):
    """Find poses of the gripper that hold a stone and hit nothing (Mascaro 2020, Sec. 5)."""

    capability = "grasping"

    @abstractmethod
    def plan(
        self, target: Stone, cloud: Cloud, T_map_base: Float, rng: "np.random.Generator"
    ) -> GraspPlan:
        """Plan grasps, best first; the same generator state gives the same plan. It may be slow.

        A stone that cannot be grasped, or has no points, gives no grasp and the reasons by number.

        Args:
            target: The stone to hold, with its best known surface.
            cloud: Surroundings in the map, the stone and the ground included.
            T_map_base: Pose of the chassis, for reach, read-only, shape (4, 4).
            rng: The only source of chance.

        Raises:
            DataError: If the pose is not finite or of another shape.
        """
