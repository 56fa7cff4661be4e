"""Equally spaced slots on free ground, and placements on them (Mascaro 2020, Sec. 6.1)."""

from collections.abc import Iterable
from typing import ClassVar

import numpy as np
from executive_plugins.placing.allowed_places import AllowedPlaces
from executive_plugins.placing.free_ground import FreeGround, GroundNeeds
from executive_plugins.placing.liftable_places import Load, assigned, loads, rated_kg, swings_rad
from executive_plugins.placing.release import HeldStone, aligned_poses, release_poses
from executive_plugins.placing.row_of_stones import row_of_stones
from executive_plugins.placing.settings import SlotsSettings
from executive_plugins.placing.slot_surroundings import SlotFoot, SlotSurroundings
from executive_plugins.placing.spaced_row import spaced_row

from executive.arrays import Float, checked
from executive.config import Settings
from executive.errors import DataError
from executive.geometry.pose import inverse, pose, transform
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.placing import PlacementPlanner
from executive.machine.machine import Machine
from executive.messages.cloud import Cloud
from executive.messages.placement import Placement, Slot
from executive.messages.segment import Segmentation
from executive.messages.slot_layout import ANYWHERE, Row, SlotLayout
from executive.messages.stone import Stone


class Slots(PlacementPlanner):
    """Rows of slots on arcs around the machine.

    A stone keeps its attitude to gravity and turns with the cabin.
    """

    Settings: ClassVar[type[Settings]] = SlotsSettings
    latency_s: ClassVar[dict[str, float]] = {"slots": 0.5, "plan": 0.2}
    is_stateless: ClassVar[bool] = True

    def __init__(self, settings: SlotsSettings, machine: Machine, motion: MotionPlanner) -> None:
        self._settings = settings
        self._machine = machine
        self._motion = motion

    def slots(
        self,
        segmentation: Segmentation,
        T_map_base: Float,
        count: int,
        layout: SlotLayout = ANYWHERE,
    ) -> tuple[Slot, ...]:
        """Return up to `count` slots on free, known, nearly flat ground in reach.

        On arcs, those that need the least swing of the cabin come first. The first row
        with room for all slots is taken; if there is none, the rows are filled one after the other.
        For a machine that may tip the rows start at the nearest, and each stone of the site gets a
        place where the machine may lift it, with the least swings of the cabin in all; see
        `liftable_places`. A layout with a row of its own gives the places along that row instead;
        there the distance of faces takes the place of `clearance_m` and `spacing_m`.
        """
        T_map_base = checked("T_map_base", T_map_base, 4, 4)
        if layout.row is not None:
            return tuple(self._in_row(layout, layout.row, segmentation, T_map_base, count))
        s = self._settings
        ground = FreeGround(
            segmentation, GroundNeeds(s.clearance_m, s.max_slope_rad, s.max_roughness_m)
        )
        allowed = AllowedPlaces(layout)
        places = np.empty((0, 3))
        for radius_m in self._radii_m():
            row = self._row(radius_m, ground, places, T_map_base, allowed)
            is_enough = len(row) >= count and not self._is_nearest_first
            places = row if is_enough else np.concatenate([places, row])
            if len(places) >= count and not self._is_by_capacity:
                break
        if self._is_by_capacity and len(places):
            return self._by_capacity(places, loads(segmentation), T_map_base, count)
        return tuple(Slot(i, place) for i, place in enumerate(places[:count], start=1))

    def _by_capacity(
        self, places: Float, stones: list[Load], T_map_base: Float, count: int
    ) -> tuple[Slot, ...]:
        """Return a slot for each stone, and further ones after them."""
        rated = rated_kg(self._machine, places, T_map_base)
        swings = swings_rad(stones, places, T_map_base)
        chosen = assigned(rated, [one.mass_kg for one in stones], swings, count)
        return tuple(
            Slot(
                i,
                places[place],
                meant_for_map=None if stone is None else stones[stone].position_map,
            )
            for i, (place, stone) in enumerate(chosen, start=1)
        )

    @property
    def _is_by_capacity(self) -> bool:
        """Whether the stones of the site get places where the machine may lift them."""
        prefer = self._settings.prefer
        return prefer == "capacity" or (prefer == "by_base" and self._machine.stance.is_free)

    @property
    def _is_nearest_first(self) -> bool:
        """Whether each place near the machine comes before those that are farther off."""
        return self._is_by_capacity or self._settings.prefer == "nearest"

    def _radii_m(self) -> tuple[float, ...]:
        """Return the distances of rows from the machine, preferred first [m]."""
        radii_m = self._settings.radii_m
        return tuple(sorted(radii_m)) if self._is_nearest_first else radii_m

    def _in_row(
        self,
        layout: SlotLayout,
        row: Row,
        segmentation: Segmentation,
        T_map_base: Float,
        count: int,
    ) -> list[Slot]:
        """Return the places along a row; the distance to stones is that of their faces."""
        s = self._settings
        needs = GroundNeeds(0.0, s.max_slope_rad, s.max_roughness_m)
        ground = FreeGround(segmentation, needs)

        def height_m(xy: Float) -> float | None:
            if np.linalg.norm(xy - T_map_base[:2, 3]) > self._machine.reach_m:
                return None
            height = ground.height_m(xy)
            if height is None or not self._reaches(self._over(np.array([*xy, height])), T_map_base):
                return None
            return height

        start_m = float(np.linalg.norm(row.start_map - T_map_base[:2, 3]))
        return row_of_stones(layout, row, count, start_m + self._machine.reach_m, height_m)

    def plan(
        self, stone: Stone, slot: Slot, T_map_gripper: Float, cloud: Cloud, T_map_base: Float
    ) -> tuple[Placement, ...]:
        """Return placements of the stone, those with the least turn against the cabin first.

        The centre of volume of the model's hull goes over the slot; the mean of the seen points
        would be about 0.2 m closer to the sensor. The bottom of the stone is just above the highest
        ground under it. A slot with the pose of a stone has one placement: that pose, and as much
        above it.

        Raises:
            DataError: If the cloud is not in the map, or the stone's points span no volume.
        """
        if cloud.frame != "map":
            raise DataError(
                f"the placement planner needs a cloud in the frame 'map', got '{cloud.frame}'"
            )
        s = self._settings
        T_map_gripper = checked("T_map_gripper", T_map_gripper, 4, 4)
        held = HeldStone.of(stone.points_map, cloud.points)
        box = None
        if slot.T_map_object is None and slot.heading_rad is not None:
            box, held = stone.box_map, held.centred(stone.box_map.centre)
        around = SlotSurroundings(
            self._machine.gripper,
            cloud.points,
            SlotFoot.of(slot, held.radius_m, box, s.drop_m),
        )
        bottom_m = around.ground_m + s.drop_m
        motions: Iterable[Float]
        if slot.T_map_object is not None:
            to_rest = slot.T_map_object @ inverse(stone.T_map_object)
            motions = [pose(t=np.array([0.0, 0.0, s.drop_m])) @ to_rest]
        elif box is None or slot.heading_rad is None:
            motions = release_poses(held, slot.position_map, bottom_m, T_map_base, s.turns)
        else:
            turn_rad = slot.heading_rad - box.heading_rad
            motions = aligned_poses(held, slot.position_map, bottom_m, turn_rad, s.turns)
        placements: list[Placement] = []
        for T_map_map in motions:
            T = T_map_map @ T_map_gripper
            if around.is_free(T, transform(T_map_map, held.points)) and self._reaches(
                T, T_map_base
            ):
                own = slot.T_map_object
                at_rest = T_map_map @ stone.T_map_object if own is None else own
                placements.append(Placement(slot, T, at_rest))
            if len(placements) == s.max_placements:
                break
        return tuple(placements)

    def _row(
        self,
        radius_m: float,
        ground: FreeGround,
        chosen: Float,
        T_map_base: Float,
        allowed: AllowedPlaces,
    ) -> Float:
        s = self._settings

        def height_m(xy: Float) -> float | None:
            if not allowed.at(xy):
                return None
            is_apart = (np.linalg.norm(chosen[:, :2] - xy, axis=1) >= s.spacing_m).all()
            return ground.height_m(xy) if is_apart else None

        row = spaced_row(radius_m, s.spacing_m, s.sector_rad, T_map_base, height_m)
        return (
            row[[self._reaches(self._over(place), T_map_base) for place in row]]
            if len(row)
            else row
        )

    def _over(self, place: Float) -> Float:
        """Return a gripper pose that hangs over a place, with its closed tips at the ground.

        The jaws open along x.
        """
        above = np.array([0.0, 0.0, float(self._machine.gripper.tips(0.0)[:, 0].max())])
        return pose(np.array([[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]]), place + above)

    def _reaches(self, T_map_gripper: Float, T_map_base: Float) -> bool:
        """Return whether the arm reaches the pose and the start of the descent above it."""
        T_base_gripper = inverse(T_map_base) @ T_map_gripper
        above = (
            inverse(T_map_base)
            @ pose(t=np.array([0.0, 0.0, self._settings.approach_m]))
            @ T_map_gripper
        )
        seed = self._machine.posture("carry")
        return all(self._motion.reach(T, seed) is not None for T in (T_base_gripper, above))
