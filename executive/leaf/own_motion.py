"""What an empty arm seems to lift while it speeds up and slows down, as weighed by its efforts."""

from typing import TYPE_CHECKING

import numpy as np

from executive.arrays import Float
from executive.leaf.context import Context
from executive.messages.trajectory import JointTrajectory

if TYPE_CHECKING:
    from executive.machine.dynamics import Dynamics

_STEP_S = 0.1  # of the samples of a motion
# A force that sets in at once moves a spring by twice what it does at rest; the drives of the arm
# are late, by up to the dead time and lag of hydraulic valves.
_SURGE, _LATE_S, _EARLY_S = 2.0, 0.5, 0.1
_UP = np.array([0.0, 0.0, 1.0])


class OwnMotion:
    """The mass that an empty arm seems to carry on its way along a trajectory.

    An arm of some tonnes that brakes on its way down pulls at its own joints as a stone would: one
    told 666 kg at 7 m, where nothing touched it.

    Args:
        context: The leaf's view of the mission.
        trajectory: What the arm is to follow, from now on.
    """

    def __init__(self, context: Context, trajectory: JointTrajectory) -> None:
        from executive.machine.dynamics import Dynamics  # imports Pinocchio

        self._began_s = context.now_s()
        count = max(3, int(np.ceil(trajectory.duration_s / _STEP_S)) + 1)
        self._times_s = np.linspace(0.0, max(trajectory.duration_s, _STEP_S), count)
        machine, dynamics = context.machine(), Dynamics(context.machine())
        q = np.tile(context.arm(), (count, 1))
        columns = [machine.arm_names.index(name) for name in trajectory.names]
        q[:, columns] = [trajectory.at(time_s)[0] for time_s in self._times_s]
        dq = np.gradient(q, self._times_s, axis=0)
        ddq = np.gradient(dq, self._times_s, axis=0)
        motion = zip(q, dq, ddq, strict=True)
        self._seems_kg = np.array([_seems_kg(dynamics, *one) for one in motion])

    def beyond(self, hangs_kg: float, now_s: float) -> float:
        """Return what hangs in the jaws beyond what the motion itself may tell by now [kg].

        Args:
            hangs_kg: What seems to hang in the jaws.
            now_s: The mission's time [s].
        """
        since_s = now_s - self._began_s
        after, before = since_s - _LATE_S, since_s + _EARLY_S
        near = self._seems_kg[(self._times_s >= after) & (self._times_s <= before)]
        low, high = near.min(initial=0.0), near.max(initial=0.0)
        return hangs_kg - float(np.clip(hangs_kg, _SURGE * low, _SURGE * high))


def _seems_kg(dynamics: "Dynamics", q: Float, dq: Float, ddq: Float) -> float:
    """Return the mass at rest whose efforts are most like those of a motion of the empty arm."""
    still = np.zeros_like(q)
    rest = dynamics.efforts(q, still, still, _UP, 0.0)
    lever = dynamics.efforts(q, still, still, _UP, 1.0) - rest
    more = dynamics.efforts(q, dq, ddq, _UP, 0.0) - rest
    return float(lever @ more / max(float(lever @ lever), 1e-9))
