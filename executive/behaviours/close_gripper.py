"""Close the jaws on a stone."""

from typing import Any

import numpy as np
from pydantic import Field

from executive.behaviours.action import Action, Steps
from executive.behaviours.jaws import drive_jaws
from executive.behaviours.outcome import failed, succeeded
from executive.behaviours.port import Port
from executive.config import Meters, Newtons, Radians, Settings
from executive.messages.hold import Hold
from executive.messages.stone import Stone, StoneState

_STANDING = (StoneState.ON_GROUND, StoneState.PLACED, StoneState.SET_ASIDE)


class CloseGripperSettings(Settings):
    force: Newtons | None = Field(None, gt=0, description="Force at each tip [N]; by default the gripper's own.")
    empty_below: Radians = Field(0.08, ge=0, le=1, description="Jaws that close further hold nothing [rad].")
    removal_radius: Meters = Field(1.0, gt=0, le=3, description="R_obj: least radius of what the map forgets [m].")


class CloseGripper(Action):
    """Close the jaws, and if they hold something, say so to the database, the map and the monitors.

    Mascaro 2020, Sec. 4.5: the gripper's pose is stored with the stone, and the map forgets a sphere of R_obj = 1 m.
    Beyond the paper: what the sphere takes from stones beside this one is put back from the database, for no scan may
    come before the next plan.
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
        stone = self.context.plugin("objects").grasp(hold.stone_id, hold.T_map_gripper, self.context.now_s())
        mapping = self.context.plugin("mapping")
        reach_m = _reach_of(stone.points_map, stone.centroid_map)
        # Deviation from the paper: the sphere takes in the whole stone. What a long one left outside R_obj was
        # segmented as another stone later.
        radius_m = max(self.settings.removal_radius, reach_m)
        removed = mapping.remove_sphere(stone.centroid_map, radius_m)
        put_back = self._put_back_neighbours(stone, radius_m)
        mapping.mask_held(reach_m)
        self.context.begin_hold()
        self.context.note("grasped", stone=stone.id, jaw_rad=angle, removed_points=removed, put_back_points=put_back)
        return succeeded(hold=hold)

    def _put_back_neighbours(self, held: Stone, radius_m: float) -> int:
        """Put back what the sphere took from the models of other stones; return the number of points."""
        put_back = 0
        for stone in self.context.plugin("objects").stones():
            if stone.id != held.id and stone.state in _STANDING:
                cut = stone.points_map[np.linalg.norm(stone.points_map - held.centroid_map, axis=1) <= radius_m]
                self.context.plugin("mapping").add_surface(cut)
                put_back += len(cut)
        return put_back


def _reach_of(points: Any, centre: Any) -> float:
    """Return the distance [m] of the farthest point from the centre, and a hand's breadth more."""
    return float((((points - centre) ** 2).sum(axis=1) ** 0.5).max()) + 0.1
