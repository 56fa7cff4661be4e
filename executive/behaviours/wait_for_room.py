"""Wait until the jaws have room to open."""

import numpy as np
from pydantic import Field

from executive.config import Meters, Seconds, Settings
from executive.geometry.pose import inverse, transform
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.outcome import succeeded
from executive.machine.jaw_clearance import ROOM_M, can_open


class WaitForRoomSettings(Settings):
    room: Meters = Field(
        ROOM_M, ge=0, le=0.5, description="Room between the opening jaws and known stones [m]."
    )
    most: Seconds = Field(5.0, ge=0, le=60, description="Longest time that is waited [s].")


class WaitForRoom(Action[WaitForRoomSettings]):
    """Wait while jaws that opened fully would touch a known stone, as the arm moves away from it.

    A path is planned with open jaws, and what they touch at its start is taken for known: beside a
    stone that was just set down, jaws that open before the arm has moved press on it. After the
    longest time the leaf succeeds all the same: the jaws have to be open at the end of the way.
    """

    needs = (ObjectDatabase,)
    on_resume = OnResume.REDO

    def run(self) -> Steps[None]:
        began_s = self.context.now_s()
        while not self._has_room():
            waited_s = self.context.now_s() - began_s
            if waited_s >= self.settings.most:
                return succeeded(reason=f"no room for open jaws after {waited_s:.1f} s")
            yield None
        return succeeded()

    def _has_room(self) -> bool:
        gripper, T_map_gripper = self.context.machine().gripper, self.context.gripper()
        radius_m = float(np.linalg.norm(gripper.tips(gripper.open_rad), axis=1).max())
        objects = self.context.use(ObjectDatabase)
        around = objects.surface_within(T_map_gripper[:3, 3], radius_m + self.settings.room)
        now_rad = self.context.joints().of(self.context.machine().jaw.name)[0]
        stones = transform(inverse(T_map_gripper), around)
        return can_open(gripper, stones, now_rad, gripper.open_rad, self.settings.room)
