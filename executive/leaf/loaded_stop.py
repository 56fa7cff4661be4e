"""How quickly a motion may be stopped by what hangs in the jaws: for the step that follows it."""

import numpy as np

from executive.leaf.context import Context
from executive.messages.trajectory import JointTrajectory

_LIGHT = 0.05  # share of the payload below which nothing hangs: efforts are measured with noise


def least_stop_s(context: Context, trajectory: JointTrajectory, load_kg: float) -> float:
    """Return the least time in which a stop may take the speed of a motion away [s].

    Args:
        context: The leaf's view of the mission, before the motion begins.
        trajectory: The motion.
        load_kg: What may come to hang in the jaws on the way, where that is more than now [kg].

    Returns:
        0, so that only the joints limit it, without a load and on a base that does not yield.
    """
    machine = context.machine()
    if machine.stance.support_n_m is None:
        return 0.0
    weighed_kg = context.payload_kg()
    load_kg = max(load_kg, weighed_kg or 0.0)
    if load_kg < _LIGHT * machine.payload_kg:
        return 0.0
    from executive.machine.loaded_stop import LoadedStop  # imports kinematics

    positions = np.tile(context.arm(), (len(trajectory.times_s), 1))
    velocities = np.zeros_like(positions)
    columns = [machine.arm_names.index(name) for name in trajectory.names]
    positions[:, columns], velocities[:, columns] = trajectory.position, trajectory.velocity
    return LoadedStop(machine).least_s(positions, velocities, load_kg)


def stop_now_s(context: Context, load_kg: float) -> float:
    """Return the least time in which a stop may take the arm's present speed away [s].

    Args:
        context: The leaf's view of the mission.
        load_kg: What hangs in the jaws now [kg].
    """
    machine, sample = context.machine(), context.joints()
    if machine.stance.support_n_m is None:
        return 0.0
    from executive.machine.loaded_stop import LoadedStop  # imports kinematics

    q, dq = np.array([sample.of(name)[:2] for name in machine.arm_names]).T
    return LoadedStop(machine).least_s(q[None], dq[None], load_kg)
