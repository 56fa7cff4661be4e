"""Raise the gripper beside a stone, with the jaws as they are: a step that leaves share."""

from collections.abc import Generator

from executive.interfaces.motion import MotionPlanner
from executive.leaf.context import Context
from executive.leaf.follow import follow
from executive.leaf.job import Job
from executive.leaf.rest import come_to_rest
from executive.leaf.surroundings import surroundings
from executive.messages.request import MoveRequest


def raise_gripper(
    context: Context, stone: int, by_m: float
) -> Generator[Job[object] | None, object, str]:
    """Raise the gripper straight up, and return why it was not; empty if it was.

    Args:
        context: The leaf's view of the mission; it needs robot, motion, mapping and objects.
        stone: Id of the stone at the jaws, which is no obstacle.
        by_m: How far [m].
    """
    T_map_gripper = context.gripper()
    T_map_gripper[2, 3] += by_m
    obstacles = yield from surroundings(context, stone)
    request = MoveRequest(
        start=context.arm(),
        T_map_gripper=T_map_gripper,
        T_map_base=context.state().T_map_base,
        leave_m=by_m,
        arrive_m=0.0,
        obstacles=obstacles,
        held_gripper=None,
        jaw_rad=context.joints().of(context.machine().jaw.name)[0],
    )
    plan = yield from context.job(context.use(MotionPlanner).move, request)
    if plan.trajectory is None:
        return f"no way up: {plan.reason}"
    moved = yield from follow(context, plan.trajectory)
    return moved.reason if not moved.success else (yield from come_to_rest(context))
