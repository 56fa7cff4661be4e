"""Let a held stone go."""

from typing import Any

from pydantic import Field

from executive.arrays import Float
from executive.config import Newtons, Radians, Settings
from executive.geometry.pose import transform
from executive.leaf.action import Action, Steps
from executive.leaf.jaws import drive_jaws
from executive.leaf.outcome import failed, succeeded
from executive.leaf.port import Port
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import gap_below, held_surface, surroundings
from executive.messages.hold import Hold
from executive.messages.placement import Placement
from executive.messages.stone import StoneState


class ReleaseStoneSettings(Settings):
    force: Newtons | None = Field(
        None, gt=0, description="Force at each tip [N]; by default the gripper's own."
    )
    clearance: Radians = Field(
        0.2, gt=0, le=2, description="Opening beyond that of the hold [rad]."
    )


class ReleaseStone(Action):
    """Open the jaws a little and move the stone's model by the gripper's motion since the grasp
    (Mascaro 2020, Eq. 3).

    Only a little: jaws that open wide beside another stone push it away. Deviation from the paper:
    a stone that is let go without a placement is believed on the ground below, for nothing holds it
    in the air: one that has slid out of the jaws did not rise with them.
    """

    Settings = ReleaseStoneSettings
    needs = ("robot", "objects", "mapping", "monitoring")
    inputs = {
        "hold": Port(Hold, "which stone is held, and how"),
        "placement": Port(
            Placement,
            "the placement that was carried out; without one the stone is just let go",
            optional=True,
        ),
    }

    def run(self, **inputs: Any) -> Steps:
        hold: Hold = inputs["hold"]
        placement: Placement | None = inputs.get("placement")
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        T_map_gripper = self.context.gripper()
        self.context.end_hold()
        opening = min(
            hold.jaw_rad + self.settings.clearance, self.context.machine().gripper.open_rad
        )
        yield from drive_jaws(self.context, opening, self.settings.force)
        self.context.plugin("mapping").mask_held(0.0)
        state = StoneState.ON_GROUND if placement is None else StoneState.PLACED
        if placement is None:
            T_map_gripper[2, 3] -= self._fall_m(hold, T_map_gripper)
        stone = self.context.plugin("objects").release(
            hold.stone_id, T_map_gripper, self.context.now_s(), state
        )
        self.context.show(f"stones/{stone.id}", stone)
        if placement is None:
            self.context.note("let_go", stone=stone.id, estimated_pose=stone.T_map_object)
        else:
            self.context.note(
                "released",
                stone=stone.id,
                slot=placement.slot.id,
                slot_position=placement.slot.position_map,
                planned_pose=placement.T_map_object,
                estimated_pose=stone.T_map_object,
            )
        return succeeded()

    def _fall_m(self, hold: Hold, T_map_gripper: Float) -> float:
        """Return how far the held stone is above the ground below it [m]."""
        stone_map = transform(T_map_gripper, held_surface(self.context, hold))
        return max(
            0.0, gap_below(stone_map, surroundings(self.context, without=hold.stone_id).points)
        )
