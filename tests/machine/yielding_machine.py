"""The M545 on supports that yield, with its cabin turned."""

import numpy as np

from executive.machine.machine import Machine, load_machine

M545 = load_machine("m545")
STIFFNESS_N_M = 2e6


def yielding(stiffness_n_m: float | None) -> Machine:
    """Return the machine with supports of a stiffness each; None if that is not known."""
    stance = M545.stance.model_copy(update={"support_n_m": stiffness_n_m})
    return M545.model_copy(update={"stance": stance})


def turned(angle_rad: float) -> np.ndarray:
    """Return the posture in which stones are carried, with the cabin turned by an angle."""
    q = M545.posture("carry").copy()
    q[M545.arm_names.index(M545.turn_joint)] += angle_rad
    return q
