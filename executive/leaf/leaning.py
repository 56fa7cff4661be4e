"""Where the chassis will be once the arm has moved: for the plans of a pick and a placement."""

from collections.abc import Generator

from executive.arrays import Float
from executive.geometry.pose import inverse
from executive.interfaces.motion import MotionPlanner
from executive.leaf.context import Context
from executive.leaf.job import Job


def leaning(
    context: Context, T_map_gripper: Float, load_kg: float = 0.0
) -> Generator[Job[object], object, Float]:
    """Return where the chassis is once the gripper is at a pose, shape (4, 4).

    Legs yield to the moments of the arm, and to that of what hangs in the jaws. It is where it is
    now on a base that does not yield, and for a pose that is out of reach.

    Args:
        context: The leaf's view of the mission; it needs motion.
        T_map_gripper: Where the gripper is to be, shape (4, 4).
        load_kg: What hangs in the jaws now, and there [kg].
    """
    machine, T_map_base = context.machine(), context.state().T_map_base
    if machine.stance.support_n_m is None:
        return T_map_base
    from executive.machine.lean import Lean  # reading a mission imports no kinematics

    start, lean = context.arm(), Lean(machine)
    reach = context.use(MotionPlanner).reach
    goal = yield from context.job(reach, inverse(T_map_base) @ T_map_gripper, start)
    return T_map_base if goal is None else lean.moved(T_map_base, start, goal, load_kg)
