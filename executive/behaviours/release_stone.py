"""Let a held stone go."""

from typing import Any

from pydantic import Field

from executive.behaviours.action import Action, Steps
from executive.behaviours.jaws import drive_jaws
from executive.behaviours.outcome import succeeded
from executive.behaviours.port import Port
from executive.config import Newtons, Settings
from executive.messages.hold import Hold
from executive.messages.placement import Placement
from executive.messages.stone import StoneState


class ReleaseStoneSettings(Settings):
    force: Newtons = Field(35e3, gt=0, le=200e3, description="Largest force at each tip while opening [N].")


class ReleaseStone(Action):
    """Open the jaws and move the stone's model by what the gripper moved since the grasp (Mascaro 2020, Eq. 3)."""

    Settings = ReleaseStoneSettings
    needs = ("robot", "objects", "mapping", "monitoring")
    inputs = {
        "hold": Port(Hold, "which stone is held, and how"),
        "placement": Port(
            Placement, "the placement that was carried out; without one the stone is just let go", optional=True
        ),
    }

    def run(self, **inputs: Any) -> Steps:
        hold: Hold = inputs["hold"]
        placement: Placement | None = inputs.get("placement")
        T_map_gripper = self.context.gripper()
        self.context.end_hold()
        yield from drive_jaws(self.context, self.context.machine().gripper.open_rad, self.settings.force)
        self.context.plugin("mapping").mask_held(0.0)
        state = StoneState.ON_GROUND if placement is None else StoneState.PLACED
        stone = self.context.plugin("objects").release(hold.stone_id, T_map_gripper, self.context.now_s(), state)
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
