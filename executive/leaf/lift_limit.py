"""Whether the machine may carry a mass along a planned motion."""

from typing import Literal

from executive.leaf.context import Context
from executive.messages.request import MotionPlan

LiftRule = Literal["by_base", "payload", "iso_10567"]


def too_heavy(context: Context, plan: MotionPlan, mass_kg: float, rule: LiftRule) -> str:
    """Return why the machine may not carry a mass along a path; empty if it may.

    Args:
        context: The leaf's view of the mission.
        plan: The path; if there is none, nothing is too heavy for it.
        mass_kg: The mass in the jaws [kg].
        rule: What limits it: `payload` nothing more than at the grasp, `iso_10567` the rated lift
            capacity by radius and side on the whole path, and `by_base` that where the machine may
            tip.
    """
    stance = context.machine().stance
    if plan.trajectory is None or not stance.limits_by_tipping(rule):
        return ""
    from executive.machine.lift_capacity import LiftCapacity  # imports kinematics

    return LiftCapacity(context.machine()).along(plan.trajectory.position).refusal(mass_kg)
