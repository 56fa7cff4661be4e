"""How a machine leans on supports that yield: by the moments of its own links.

Each point of support is a spring along the vertical. The weights of the links, and of a load in the
jaws, sink and tilt the machine until the springs bear them; that depends on where the arm is.
"""

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import exp_so3
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine
from executive.machine.stance import Stance


class Lean:
    """The lean of one machine.

    Args:
        machine: The machine; without a stiffness of its supports it does not lean.
    """

    def __init__(self, machine: Machine) -> None:
        self._machine, self._kinematics = machine, Kinematics(machine)
        self._support_n_m = machine.stance.support_n_m or 0.0

    def moved(self, T_map_base: Float, q_from: Float, q_to: Float, load_kg: float = 0.0) -> Float:
        """Return where the chassis is once the arm has gone from one posture to another, (4, 4).

        Args:
            T_map_base: Pose of the chassis with the arm in the first posture, shape (4, 4).
            q_from: The first posture [rad] or [m], shape (n,).
            q_to: The other one, shape (n,).
            load_kg: Mass that hangs in the jaws in both [kg].
        """
        if not self._support_n_m:
            return T_map_base
        return np.asarray(
            T_map_base @ inverse(self._leant(q_from, load_kg)) @ self._leant(q_to, load_kg)
        )

    def _leant(self, q: Float, load_kg: float) -> Float:
        """Return the pose of the leaning chassis in the level one, shape (4, 4).

        The unknowns are the heave and the small turns about x and y.
        """
        yields = support_rows(self._machine.stance)
        frames = self._kinematics.frames(q)
        places = [
            (link.mass_kg, transform(frames[name], np.array(link.com_m)))
            for name, link in self._machine.links.items()
        ]
        hangs = transform(frames["gripper"], self._machine.gripper.grasp_centre)
        load = np.zeros(3)
        for mass_kg, (x, y, _) in [*places, (load_kg, hangs)]:
            load -= mass_kg * GRAVITY_M_S2 * np.array([1.0, y, -x])
        stiffness = self._support_n_m * yields.T @ yields
        heave_m, turn_x, turn_y = np.linalg.solve(stiffness, load)
        turn = pose(R=exp_so3(np.array([turn_x, turn_y, 0.0])))
        foot = pose(t=np.array([0.0, 0.0, -self._machine.stance.base_height_m]))
        return pose(t=np.array([0.0, 0.0, heave_m])) @ foot @ turn @ inverse(foot)


def support_rows(stance: Stance) -> Float:
    """Return how far each support goes up with the heave and the turns about x and y, (L, 3).

    One at (x, y) goes up by heave + y·turn_x − x·turn_y.
    """
    supports = np.array(stance.supports_m).reshape(-1, 2)
    return np.column_stack([np.ones(len(supports)), supports[:, 1], -supports[:, 0]])
