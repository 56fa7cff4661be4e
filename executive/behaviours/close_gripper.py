"""Close the jaws on a stone."""

from typing import Any

from pydantic import Field

from executive.config import Meters, Newtons, Radians, Settings
from executive.leaf.action import Action, Steps
from executive.leaf.jaws import drive_jaws
from executive.leaf.outcome import failed, succeeded
from executive.leaf.port import Port
from executive.leaf.removal import reach_of, remove_from_map
from executive.messages.hold import Hold


class CloseGripperSettings(Settings):
    force: Newtons | None = Field(
        None, gt=0, description="Force at each tip [N]; by default the gripper's own."
    )
    empty_below: Radians = Field(
        0.08, ge=0, le=1, description="Jaws that close further hold nothing [rad]."
    )
    removal_radius: Meters = Field(
        1.0, gt=0, le=3, description="R_obj: least radius of what the map forgets [m]."
    )


class CloseGripper(Action):
    """Close the jaws, and if they hold something, say so to the database, the map and the monitors.

    Mascaro 2020, Sec. 4.5: the gripper's pose is stored with the stone, and the map forgets a
    sphere of R_obj = 1 m, see `removal`.
    """

    Settings = CloseGripperSettings
    needs = ("robot", "objects", "mapping", "monitoring")
    inputs = {"stone": Port(int, "id of the stone")}
    outputs = {"hold": Port(Hold, "which stone is held, and how")}

    def run(self, **inputs: Any) -> Steps:
        angle = yield from drive_jaws(self.context, 0.0, self.settings.force)
        if angle < self.settings.empty_below:
            reason = f"the jaws closed to {angle:.2f} rad: nothing is between them"
            self.context.note("closed_on_nothing", stone=inputs["stone"], reason=reason)
            return failed(reason)
        hold = Hold(inputs["stone"], self.context.gripper(), angle)
        stone = self.context.plugin("objects").grasp(
            hold.stone_id, hold.T_map_gripper, self.context.now_s()
        )
        removed, put_back = remove_from_map(self.context, stone, self.settings.removal_radius)
        self.context.plugin("mapping").mask_held(reach_of(stone))
        self.context.begin_hold()
        self.context.note(
            "grasped",
            stone=stone.id,
            jaw_rad=angle,
            removed_points=removed,
            put_back_points=put_back,
        )
        return succeeded(hold=hold)
