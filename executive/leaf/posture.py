"""Move the arm's joints to given positions, around what is known: the step that leaves share."""

from executive.arrays import Float
from executive.interfaces.mapping import Mapper
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.robot import Robot
from executive.leaf.action import Steps
from executive.leaf.context import Context
from executive.leaf.follow import follow
from executive.leaf.free_motion import FreeMotion
from executive.leaf.outcome import failed
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import held_kg, held_stone, held_surface, surroundings
from executive.messages.hold import Hold
from executive.messages.request import PostureRequest

POSTURE_NEEDS = (Robot, MotionPlanner, Mapper, ObjectDatabase)


def move_to_posture(context: Context, goal: Float, hold: Hold | None) -> Steps[None]:
    """Plan a way to joint positions and follow it; the jaws stay as they are.

    An arm that holds nothing stops once it presses on something or lifts something.

    Args:
        context: The leaf's view of the mission; it needs `POSTURE_NEEDS`.
        goal: Wanted positions of the arm's joints [rad] or [m], shape (n,).
        hold: How a stone is held. It counts only while the database says that the stone is held,
            since the key outlives the grasp.
    """
    held = held_stone(context)
    if held is not None and (hold is None or hold.stone_id != held):
        return failed(f"stone {held} is held, and the input 'hold' does not say how", is_final=True)
    if moving := (yield from come_to_rest(context)):
        return failed(moving)
    obstacles = yield from surroundings(context, held)
    request = PostureRequest(
        start=context.arm(),
        goal=goal,
        T_map_base=context.state().T_map_base,
        obstacles=obstacles,
        held_gripper=None if held is None or hold is None else held_surface(context, hold),
        jaw_rad=context.joints().of(context.machine().jaw.name)[0],
        held_kg=None if held is None else held_kg(context),
    )
    plan = yield from context.job(context.use(MotionPlanner).move_joints, request)
    if plan.trajectory is None:
        return failed(f"no way there: {plan.reason}")
    context.show("path", plan)
    way = follow(context, plan.trajectory)
    if held is None:
        way = FreeMotion(context, plan.trajectory).watched(way)
    return (yield from way)
