"""Plan the way of a held stone straight up: the step that a trial lift and a look share."""

from collections.abc import Generator

from executive.interfaces.motion import MotionPlanner
from executive.leaf.context import Context
from executive.leaf.job import Job
from executive.leaf.surroundings import held_kg, held_surface, surroundings
from executive.messages.hold import Hold
from executive.messages.request import MotionPlan, MoveRequest


def risen_m(context: Context, hold: Hold) -> float:
    """Return the height of the gripper above where it has grasped the stone [m]."""
    return float(context.gripper()[2, 3] - hold.T_map_gripper[2, 3])


def way_up(
    context: Context, hold: Hold, way_m: float
) -> Generator[Job[object], object, MotionPlan]:
    """Plan from where the gripper is straight up.

    Whether the jaws hold the stone is not known yet, so that the joints keep the limits of a full
    load, whatever it weighs. On supports that yield, what was weighed limits the motion instead:
    it is no quicker than the machine bears.

    Args:
        context: The leaf's view of the mission; it needs motion, mapping and objects.
        hold: Which stone is held, and how.
        way_m: How far [m].
    """
    goal = context.gripper()
    goal[2, 3] += way_m
    obstacles = yield from surroundings(context, hold.stone_id)
    request = MoveRequest(
        start=context.arm(),
        T_map_gripper=goal,
        T_map_base=context.state().T_map_base,
        leave_m=way_m,
        arrive_m=0.0,
        obstacles=obstacles,
        held_gripper=held_surface(context, hold),
        jaw_rad=hold.jaw_rad,
        held_kg=_hanging_kg(context),
    )
    return (yield from context.job(context.use(MotionPlanner).move, request))


def _hanging_kg(context: Context) -> float | None:
    """Return the most that hangs in the jaws [kg]; None unless the machine stands on springs."""
    if context.machine().stance.support_n_m is None or not context.is_carried():
        return None
    return held_kg(context)
