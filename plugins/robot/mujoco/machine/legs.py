"""The machine on its legs: a chassis that is free to tilt, slide and tip, on springs with feet.

Each leg is a foot on a spring along the chassis' z axis, at a point of support of the machine's
description. A foot pushes and never pulls. Before time begins the legs are levelled, as an operator
does with the arm in its first posture; then they are locked, and only the springs yield. A machine
that drives raises them before, and stands on them again after it (`undercarriage.py`).
"""

from typing import ClassVar

import mujoco
import numpy as np
from executive_plugins.physics.surface import Surface, round_patch
from executive_plugins.robot.mujoco.physics_settings import LEG_TRAVEL_M, LegSettings
from scipy.spatial import ConvexHull

from executive.arrays import Float
from executive.errors import ConfigError, RobotError
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.machine import Machine

_FOOT_RADIUS_M = 0.15
_FOOT_SHARE = 0.004  # mass of a foot over the machine's; it is taken from the chassis
_STRONGEST = 3  # priority of the feet's contacts: above steel, soil and stone
_CONDIM = 4
_GAIN = 0.1  # of the legs' drives: the share of what is missing that an integration step adds
_ALIKE = 0.02  # of a load: as near to it as a leg is put down


def legs_names(machine: Machine) -> tuple[str, ...]:
    """Return a name for each leg of a machine, in the order of its points of support."""
    return tuple(f"foot_{i + 1}" for i in range(len(machine.stance.supports_m)))


def set_on_legs(spec: mujoco.MjSpec, machine: Machine, settings: LegSettings) -> None:
    """Free the chassis, and put it on legs.

    Raises:
        ConfigError: If the machine's description has fewer than three points of support.
    """
    if len(machine.stance.supports_m) < 3:
        raise ConfigError(
            f"{machine.name} has {len(machine.stance.supports_m)} points of support and needs "
            "three to stand on its legs: give stance.supports_m in its robot.yaml, or "
            "robot.base: welded"
        )
    base = spec.body(machine.base_link)
    base.add_freejoint()
    spec.add_exclude(bodyname1=base.name, bodyname2="world")  # the feet bear, not the wheels
    total_kg = sum(link.mass_kg for link in machine.links.values())
    foot_kg = _FOOT_SHARE * total_kg
    base.mass -= foot_kg * len(machine.stance.supports_m)
    damping = 2 * settings.damping_ratio * np.sqrt(settings.stiffness_n_m * total_kg / 4)
    height_m = machine.stance.base_height_m - _FOOT_RADIUS_M
    for name, (x, y) in zip(legs_names(machine), machine.stance.supports_m, strict=True):
        foot = base.add_body(name=name, pos=[x, y, -height_m])
        joint = foot.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0.0, 0.0, 1.0])
        joint.limited, joint.range = mujoco.mjtLimited.mjLIMITED_TRUE, [-LEG_TRAVEL_M, LEG_TRAVEL_M]
        joint.stiffness, joint.damping = [settings.stiffness_n_m, 0, 0], [damping, 0, 0]
        foot.add_geom(name=name, size=[_FOOT_RADIUS_M, 0.0, 0.0], mass=foot_kg)
        for link in machine.links:
            spec.add_exclude(bodyname1=name, bodyname2=link)


def set_footing(spec: mujoco.MjSpec, machine: Machine, soil: Surface) -> None:
    """Give the feet the friction of the soil, in which they dig; call it after all contacts."""
    for name in legs_names(machine):
        geom, surface = spec.geom(name), round_patch(soil.friction, _FOOT_RADIUS_M)
        geom.priority, geom.condim = _STRONGEST, _CONDIM
        geom.friction = [surface.friction, surface.torsional_m, 0.0]


class Legs:
    """The loads and the tilt of a machine on its legs.

    Attributes:
        most_tilt_rad: Largest tilt so far.
        least_margin_m: Least margin against tipping so far.
    """

    TIPPED_RAD: ClassVar[float] = np.radians(5.0)  # with all its weight on two tyres it leans 4.7°

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, machine: Machine) -> None:
        self._data = data
        names = legs_names(machine)
        joints = [model.joint(name) for name in names]
        self._joints = np.array([joint.id for joint in joints])
        self._qpos = np.array([joint.qposadr[0] for joint in joints])
        self._stiffness = np.array(model.jnt_stiffness[self._joints])
        self._base = model.body(machine.base_link).id
        self._links = np.array([model.body(name).id for name in machine.links])
        self._masses = np.array(model.body_mass[self._links])
        self._total_kg = self._masses.sum()
        self._model = model
        self._supports_m = np.array(machine.stance.supports_m)
        self._edges = ConvexHull(self._supports_m).equations
        self.most_tilt_rad, self.least_margin_m = 0.0, np.inf

    def weigh(self) -> None:
        """Let the legs bear the weight of the machine's own links; call it before each step.

        The drives compensate this weight at the joints of the arm. MuJoCo computes that as forces
        that hold up each link from outside, which would hold up the chassis, too: the sum of these
        forces is taken back at the chassis, where it acts on no joint of the arm.
        """
        middle = self._masses @ self._data.xipos[self._links] / self._total_kg
        x, y, _ = middle - self._data.xipos[self._base]
        f_z = -GRAVITY_M_S2 * self._total_kg
        self._data.xfrc_applied[self._base] = (0.0, 0.0, f_z, y * f_z, -x * f_z, 0.0)

    def level(self) -> None:
        """Set the springs such that the chassis is level under the weight as it is now."""
        self._model.qpos_spring[self._qpos] = -self._level_loads_n() / self._stiffness

    def _level_loads_n(self) -> Float:
        """Return what each leg bears of the weight as it is now [N], shape (L,)."""
        total_kg = self._total_kg
        middle = self._masses @ self._data.xipos[self._links] / total_kg
        away_m = middle - self._data.xpos[self._base]
        x, y = (self._data.xmat[self._base].reshape(3, 3).T @ away_m)[:2]
        # The loads of least squares that balance force and moments, as springs of one stiffness do.
        balance = np.vstack([np.ones(len(self._supports_m)), self._supports_m.T])
        return np.asarray(
            np.linalg.pinv(balance) @ (total_kg * GRAVITY_M_S2 * np.array([1.0, x, y]))
        )

    def springs_m(self) -> Float:
        """Return how far each foot is out where its spring is slack [m], shape (L,); up is > 0."""
        return np.array(self._model.qpos_spring[self._qpos])

    def set_springs(self, slack_m: Float) -> None:
        """Set what `springs_m` returns."""
        self._model.qpos_spring[self._qpos] = slack_m

    def shorten(self, to_m: float, step_m: float) -> bool:
        """Draw the feet in by a step, as far as to a height above a plane; return whether all are.

        Args:
            to_m: The height above level ground on which the machine stands on its wheels [m].
            step_m: How far one step draws them in [m].
        """
        slack_m = self.springs_m()
        self.set_springs(np.maximum(slack_m, np.minimum(slack_m + step_m, to_m)))
        return bool((slack_m >= to_m).all())

    def lengthen(self, step_m: float) -> bool:
        """Put the feet out by a step at most, towards where each bears its part of the weight.

        A foot at the end of its travel bears nothing.

        Returns:
            Whether all do, within 2 %.
        """
        loads_n = self._level_loads_n()
        away_m = (self.loads_n() - loads_n) / self._stiffness
        slack_m = self.springs_m() + np.clip(_GAIN * away_m, -step_m, step_m)
        self.set_springs(np.maximum(slack_m, -LEG_TRAVEL_M))
        return bool((np.abs(self.loads_n() - loads_n) <= _ALIKE * loads_n).all())

    def loads_n(self) -> Float:
        """Return the force of each leg on the ground [N], shape (L,); 0 of a foot in the air."""
        pressed_m = self._data.qpos[self._qpos] - self._model.qpos_spring[self._qpos]
        return np.asarray(np.maximum(self._stiffness * pressed_m, 0.0))

    def tilt_rad(self) -> float:
        """Return the angle between the chassis' z axis and the vertical [rad]."""
        return float(np.arccos(np.clip(self._data.xmat[self._base, 8], -1.0, 1.0)))

    def margin_m(self) -> float:
        """Return how far the resultant of the legs' forces is inside the area of support [m].

        It is 0 when all legs on one side are in the air: the machine begins to tip.
        """
        loads_n = self.loads_n()
        if not loads_n.any():
            return 0.0
        resultant = loads_n @ self._supports_m / loads_n.sum()
        return float(-(self._edges[:, :2] @ resultant + self._edges[:, 2]).max())

    def watch(self) -> None:
        """Note the extremes of tilt and margin.

        Raises:
            RobotError: If the machine has tipped over.
        """
        tilt_rad = self.tilt_rad()
        self.most_tilt_rad = max(self.most_tilt_rad, tilt_rad)
        self.least_margin_m = min(self.least_margin_m, self.margin_m())
        if tilt_rad > self.TIPPED_RAD:
            raise RobotError(
                f"the machine has tipped over at {self._data.time:.2f} s: its chassis leans by "
                f"{np.degrees(tilt_rad):.0f}°"
            )
