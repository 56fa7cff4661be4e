"""What the tests of placing share: slots, verdicts, ways that are not there, and placements."""

import numpy as np

from executive.geometry.pose import pose
from executive.messages.alignment import Alignment
from executive.messages.placement import Placement, Slot
from executive.messages.request import MotionPlan
from executive.messages.stone import StoneState
from executive.messages.verdict import Trouble, Verdict

NO_PATH = np.zeros((0, 3))
NO_WAY = MotionPlan(None, "the boom would hit stone 2", NO_PATH)
SLIP = Verdict(3.0, "jaw_slip", Trouble.SLIP, "jaws 0.5 m open, 0.6 m before")
DROP = Verdict(4.0, "payload_drop", Trouble.DROP, "12 kg left of 900 kg")
SLOTS = [Slot(1, np.array([4.0, -3.0, 0.0])), Slot(2, np.array([5.0, -4.0, 0.0]))]


def plugins(stand):
    return stand.leaf_context.plugins


def placement(slot, T_map_gripper=None):
    T = pose(t=slot.position_map + [0.0, 0.0, 0.5]) if T_map_gripper is None else T_map_gripper
    return Placement(slot, T, pose(t=slot.position_map))


def alignment(accepted, shift_m=0.1, reason="rmse 3 cm"):
    return Alignment(pose(t=np.array([shift_m, 0.0, 0.0])), accepted, reason, 0.03, 0.9)


def set_down(world, database, *, realigned=None):
    """Set stone 1 down as planned on slot 1; a realignment may show it elsewhere."""
    before = database.stone(1)
    database.release(1, world.hold.T_map_gripper, 5.0, StoneState.PLACED)
    if realigned is not None:
        database.realign(1, realigned, 6.0, "alignment")
    return Placement(SLOTS[0], world.hold.T_map_gripper, before.T_map_object)
