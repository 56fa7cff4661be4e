"""Release a held stone."""

from collections.abc import Generator
from typing import Any

import numpy as np
from pydantic import Field

from executive.arrays import Float
from executive.config import Meters, Newtons, Radians, Settings
from executive.events.stone import StoneLetGo, StoneReleased, StoneWeighed
from executive.geometry.gap import gap_below
from executive.geometry.pose import inverse, transform
from executive.interfaces.mapping import Mapper
from executive.interfaces.monitoring import Monitor
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.robot import Robot
from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.light_jaws import drive_lightly
from executive.leaf.lost import mark_lost
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import held_surface, surroundings
from executive.machine.jaw_clearance import RELEASE_RAD, ROOM_M, angle_beside, angle_free_of
from executive.messages.hold import Hold
from executive.messages.placement import Placement
from executive.messages.stone import Stone, StoneState
from executive.messages.verdict import Trouble


class ReleaseStoneSettings(Settings):
    force: Newtons | None = Field(
        None, gt=0, description="Force at each tip [N]; by default the gripper's own."
    )
    clearance: Radians = Field(
        0.2, gt=0, le=2, description="Opening beyond that of the hold where there is room [rad]."
    )
    least: Radians = Field(
        RELEASE_RAD / 2,
        gt=0,
        le=2,
        description="Opening beyond that of the hold beside other stones, however near they are "
        "[rad]; 7 cm at each of the M545's tips.",
    )
    room: Meters = Field(
        ROOM_M,
        ge=0,
        le=0.5,
        description="Room between each tip and the stone on the way up, and between the jaws and "
        "other stones [m]: of the errors of its pose and of the surfaces that were seen.",
    )


class ReleaseStone(Action[ReleaseStoneSettings]):
    """Open the jaws a little, and move the stone's model by the gripper's motion since the grasp.

    The jaws open only until their tips rise past the stone, because jaws that open wide beside
    another stone push it away; where that stone is in the way, they open as far as there is room,
    and at least until the tips just pass the stone. If they press on the ground so hard that they
    lift the machine, the gripper is raised before they go on.
    Source: Mascaro et al. 2020, Eq. 3. Deviation from the paper: the model of a stone that is
    released without a placement is lowered to the ground below, because nothing holds it in the
    air; a stone that has slid out of the jaws did not rise with them. A stone of which a monitor
    reported the fall is lost: it lies somewhere on the way behind.
    """

    needs = (Robot, MotionPlanner, ObjectDatabase, Mapper, Monitor)
    claims = (Part.JAWS, Part.ARM, Part.CABIN)
    on_resume = OnResume.REDO
    is_irreversible = True

    def run(self, hold: Hold, placement: Placement | None = None) -> Steps[None]:
        """Release the stone where the gripper is.

        Args:
            hold: Which stone is held, and how.
            placement: The placement that was carried out; without one the stone is just released.
        """
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        T_map_gripper = self.context.gripper()
        opening_rad = self._opening_rad(hold, T_map_gripper)
        self.context.end_hold()
        force_n, stone_id = self.settings.force, hold.stone_id
        drive = yield from drive_lightly(self.context, opening_rad, force_n, stone_id)
        self.context.use(Mapper).mask_held(0.0)
        stone = self.context.use(ObjectDatabase).stone(hold.stone_id)
        if stone.state is StoneState.HELD:  # not so when a run is resumed after the release
            stone = yield from self._released(hold, T_map_gripper, placement)
        self.context.show(f"stones/{stone.id}", stone)
        self._record(stone, placement)
        self._keep_weight(stone.id, placement)
        self._keep_grasp(stone, T_map_gripper, placement)
        return succeeded(reason=drive.told)

    def _keep_weight(self, stone_id: int, placement: Placement | None) -> None:
        """Store what the stone weighs, unless it was let go before it hung free, or it has slipped.

        Until it hangs the ground carries a part of it, or holds it back, and a stone that slides
        jerks at the arm: of 26 weights of such holds five were off by more than 2.5 deviations, and
        of 269 others nine. What fell at once hung free until then: eight such weights were within
        1.7 deviations of what the stone weighed later.
        """
        weight, is_free = self.context.weight(), self.context.is_carried() or placement is not None
        has_slid = any(one.trouble is not Trouble.DROP for one in self.context.verdicts())
        if weight is None or not is_free or has_slid:
            return
        self.context.use(ObjectDatabase).weigh(stone_id, weight, self.context.now_s())
        self.context.record(StoneWeighed(stone_id, weight.mass_kg, weight.std_kg))

    def _keep_grasp(self, stone: Stone, T_map_gripper: Float, placement: Placement | None) -> None:
        """Store how the stone was held, if it was on the whole way to its place."""
        if placement is not None and not self.context.verdicts():
            T_object_gripper = inverse(stone.T_map_object) @ T_map_gripper
            now_s = self.context.now_s()
            self.context.use(ObjectDatabase).keep_grasp(stone.id, T_object_gripper, now_s)

    def _opening_rad(self, hold: Hold, T_map_gripper: Float) -> float:
        """Return the angle at which the jaws come free of the stone, as far as there is room."""
        gripper, objects = self.context.machine().gripper, self.context.use(ObjectDatabase)
        s, held_rad, open_rad = self.settings, hold.jaw_rad, gripper.open_rad
        wanted_rad = min(held_rad + s.clearance, open_rad)
        if objects.stone(hold.stone_id).state is not StoneState.HELD:  # resumed after the release
            return wanted_rad
        surface, up = held_surface(self.context, hold), T_map_gripper[2, :3]
        wanted_rad = angle_free_of(gripper, surface, up, wanted_rad, s.room)
        least_rad = angle_free_of(gripper, surface, up, min(held_rad + s.least, wanted_rad), 0.0)
        radius_m = float(np.linalg.norm(gripper.tips(gripper.open_rad), axis=1).max())
        others = objects.surface_within(T_map_gripper[:3, 3], radius_m, hold.stone_id)
        others_gripper = transform(inverse(T_map_gripper), others)
        return angle_beside(gripper, others_gripper, least_rad, wanted_rad, s.room)

    def _released(
        self, hold: Hold, T_map_gripper: Float, placement: Placement | None
    ) -> Generator[Any, Any, Stone]:
        fall = next((v for v in self.context.verdicts() if v.trouble is not Trouble.SLIP), None)
        state = StoneState.ON_GROUND if placement is None else StoneState.PLACED
        if placement is None:
            T_map_gripper[2, 3] -= yield from self._fall_m(hold, T_map_gripper)
        objects, now_s = self.context.use(ObjectDatabase), self.context.now_s()
        released = objects.release(hold.stone_id, T_map_gripper, now_s, state)
        if placement is not None or fall is None:
            return released
        mark_lost(self.context, released.id, f"it fell: {fall.detail}")
        return objects.stone(released.id)

    def _record(self, stone: Stone, placement: Placement | None) -> None:
        if placement is None:
            self.context.record(StoneLetGo(stone.id, stone.T_map_object))
            return
        self.context.record(
            StoneReleased(
                stone=stone.id,
                slot=placement.slot.id,
                slot_position=placement.slot.position_map,
                planned_pose=placement.T_map_object,
                estimated_pose=stone.T_map_object,
            )
        )

    def _fall_m(self, hold: Hold, T_map_gripper: Float) -> Generator[Any, Any, float]:
        """Return the height of the held stone above the ground below it [m]."""
        stone_map = transform(T_map_gripper, held_surface(self.context, hold))
        around = yield from surroundings(self.context, hold.stone_id)
        return max(0.0, gap_below(stone_map, around.points))
