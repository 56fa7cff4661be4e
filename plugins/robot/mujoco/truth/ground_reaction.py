"""What the ground bears of the machine, and how near that is to tipping it.

Links, their accelerations, and all that they hold or press on are in the force between the chassis
and the ground, wherever the chassis stands: welded, on its wheels or on its legs.
"""

import mujoco
import numpy as np
from executive_plugins.robot.mujoco.machine.legs import legs_names
from scipy.spatial import ConvexHull

from executive.arrays import Float
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.machine import Machine


class GroundReaction:
    """The moments about the sides of the area of support."""

    def __init__(self, machine: Machine, model: mujoco.MjModel) -> None:
        self._base = model.body(machine.base_link).id
        self._root = int(model.body_rootid[self._base])
        feet = [i for i in range(model.nbody) if model.body(i).name in legs_names(machine)]
        self._feet, self._is_free = feet, model.body_dofnum[self._base] > 0
        self._links = np.array([model.body(name).id for name in machine.links])
        self._weights_n = np.array(model.body_mass[self._links]) * GRAVITY_M_S2
        self._below_m = np.array([0.0, 0.0, -machine.stance.base_height_m])
        # The sides as n·p + d ≤ 0 inside, |n| = 1, in the frame of the chassis.
        self._edges = np.asarray(ConvexHull(np.array(machine.stance.supports_m)).equations)

    def share(self, model: mujoco.MjModel, data: mujoco.MjData) -> float:
        """Return the moment that tips the machine over the one that holds it; at 1 it tips.

        About each side of the area of support, the weight of the machine's own links holds; all
        else tips or holds: what the gripper holds or presses on, and what accelerates.
        """
        mujoco.mj_rnePostConstraint(model, data)
        R_world_base = data.xmat[self._base].reshape(3, 3)
        middle = data.xpos[self._base] + R_world_base @ self._below_m
        holding = self._about_edges(self._weight(data, middle), R_world_base)
        total = self._about_edges(self._on_ground(data, middle), R_world_base)
        if holding.min() <= 0.0:
            return np.inf
        return float(max((1.0 - total / holding).max(), 0.0))

    def _weight(self, data: mujoco.MjData, middle: Float) -> Float:
        """Return moment [N·m] and force [N] of the weight about a point, world axes, shape (6,)."""
        arms_m = data.xipos[self._links] - middle
        moment_x, moment_y = -arms_m[:, 1] @ self._weights_n, arms_m[:, 0] @ self._weights_n
        return np.array([moment_x, moment_y, 0.0, 0.0, 0.0, -self._weights_n.sum()])

    def _on_ground(self, data: mujoco.MjData, middle: Float) -> Float:
        """Return moment [N·m] and force [N] on the ground about a point, world axes, shape (6,).

        MuJoCo has them about the middle of mass of the machine (com-based, moment first). Legs push
        through their feet. A chassis on wheels is carried from outside, and the weight of the links
        is held at its free joint. One on legs whose wheels bear it is carried, too; its weight is
        applied to it.
        """
        if self._feet:
            on_machine = data.cfrc_ext[self._feet].sum(axis=0)
            if data.eq_active.any():
                on_machine = on_machine + data.cfrc_ext[self._base] - self._applied(data)
        elif self._is_free:
            on_machine = data.cfrc_int[self._base] + data.cfrc_ext[self._base]
        else:
            on_machine = data.cfrc_int[self._base]
        m_x, m_y, m_z, f_x, f_y, f_z = (-on_machine).tolist()
        x, y, z = (data.subtree_com[self._root] - middle).tolist()
        return np.array(
            [
                m_x + y * f_z - z * f_y,
                m_y + z * f_x - x * f_z,
                m_z + x * f_y - y * f_x,
                f_x,
                f_y,
                f_z,
            ]
        )

    def _applied(self, data: mujoco.MjData) -> Float:
        """Return what is applied to the chassis, about the middle of mass, moment first, (6,)."""
        force, moment = np.split(data.xfrc_applied[self._base], 2)
        away_m = data.xipos[self._base] - data.subtree_com[self._root]
        return np.concatenate([moment + np.cross(away_m, force), force])

    def _about_edges(self, wrench: Float, R_world_base: Float) -> Float:
        """Return how a wrench on the ground holds the machine about each side [N·m], shape (K,).

        A force f at p has the moments (p_y·f_z, −p_x·f_z), and holds (n·p + d)·f_z.
        """
        moment, force = wrench[:3] @ R_world_base, wrench[3:] @ R_world_base
        n_x, n_y, d = self._edges.T
        return np.asarray(-n_x * moment[1] + n_y * moment[0] + d * force[2])
