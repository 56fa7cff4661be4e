"""Placement planning: where stones go, and the pose of the gripper that puts one there."""

from abc import ABC, abstractmethod

from executive.arrays import Float
from executive.interfaces.plugin import Plugin
from executive.messages.cloud import Cloud
from executive.messages.placement import Placement, Slot
from executive.messages.segment import Segmentation
from executive.messages.slot_layout import ANYWHERE, SlotLayout
from executive.messages.stone import Stone


class PlacementPlanner(Plugin, ABC):
    """Choose free places, and the gripper's pose that sets a held stone down on one (Mascaro 2020,
    Sec. 6.1).
    """

    capability = "placing"

    @abstractmethod
    def slots(
        self,
        segmentation: Segmentation,
        T_map_base: Float,
        count: int,
        layout: SlotLayout = ANYWHERE,
    ) -> tuple[Slot, ...]:
        """Return up to `count` places on free ground in reach, best first, numbered from 1.

        Deterministic; it may be slow: a job. Ground that offers no place gives an empty tuple.

        Args:
            segmentation: Ground and objects of the map.
            T_map_base: Pose of the chassis, for reach.
            count: Number of places wanted.
            layout: Regions to use and to keep off, and the row that the stones are to stand in.

        Raises:
            DataError: If the pose of the chassis is not finite or of another shape.
        """

    @abstractmethod
    def plan(
        self, stone: Stone, slot: Slot, T_map_gripper: Float, cloud: Cloud, T_map_base: Float
    ) -> tuple[Placement, ...]:
        """Return ways to set the stone down, best first; empty if there is none. Deterministic.

        Args:
            stone: The held stone, its model at its pose when the gripper stood at `T_map_gripper`.
            slot: Where it is to go.
            T_map_gripper: Pose of the gripper at the grasp.
            cloud: The map without the stone.
            T_map_base: Pose of the chassis, for reach.
        """
