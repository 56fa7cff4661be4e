"""The oil that the pump of a hydraulic machine gives, as a limit on the speed along a path."""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Float
from executive.machine.machine import Machine

_SHARE = 0.85  # of the pump's flow; the feedback of the drives has the rest
_NONE_M3 = 1e-12  # of oil for a unit of the path: no joint that needs oil moves


@dataclass(frozen=True, slots=True, eq=False)
class OilFlow:
    """What all joints together may take from the pump.

    The flow of a motion is the sum of the joints' speeds, each times its displacement, whichever
    way it moves. An average of motions has no more than the average of their flows, so that a
    motion which is smoothed keeps this limit.

    Attributes:
        displacement: Oil that each joint takes, shape (n,) [m³/rad, or m³/m].
        most_m3_s: Most that the pump gives [m³/s].
    """

    displacement: Float
    most_m3_s: float

    @classmethod
    def of(cls, machine: Machine) -> "OilFlow | None":
        """Return the limit of the arm of a machine; None if it has no hydraulics."""
        hydraulics = machine.hydraulics
        if hydraulics is None:
            return None
        taken = np.array([hydraulics.displacement[name] for name in machine.arm_names])
        return cls(taken, _SHARE * hydraulics.pump_flow_m3_s)

    def fastest(self, slope: Float) -> Float:
        """Return the highest speed of a path's parameter, shape (m,).

        Args:
            slope: How the joints move with the parameter, shape (m, n).
        """
        taken_m3 = np.abs(slope) @ self.displacement
        return np.asarray(self.most_m3_s / np.maximum(taken_m3, _NONE_M3))
