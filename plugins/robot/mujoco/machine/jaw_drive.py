"""The drive of the jaws: one force-limited speed controller; the other jaw is coupled to it.

MuJoCo integrates the damping of a velocity actuator implicitly, with two exceptions: the forces of
constraints are computed without it, and a force at its limit has none. The tie between the jaws
then swung on at 14 Hz, and moving jaws chattered at full force, as one step of the full force
changes their speed by twice their largest speed. Therefore the drive finds its force itself.
"""

from typing import TypedDict

import mujoco
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings

from executive.machine.gripper import SIDES
from executive.machine.machine import Machine

_FREE_SHARE = 0.5  # of the commanded force: jaws that need less move freely
# Of the torque that would bring the jaws to their speed within one step. What the drive moves has
# 0.77 to 0.99 of the jaws' own inertia, as the arm yields (500 postures each of m545 and mini), and
# more with a stone. The loop is stable from 0.375 of it on: the roots of
# a·z² + (1 − 2·a)·z + a − 0.5 are in the unit circle then.
_STEP_SHARE = 0.5


class KeptJaws(TypedDict):
    """Target [rad], torque commanded and its share, torque of the last step [N·m] and speed."""

    target_rad: float
    torque_nm: float
    share: float
    last_nm: float
    last_rad_s: float


def jaw_inertia(machine: Machine) -> float:
    """Return the moment of inertia of both jaws about their pivots [kg·m²]."""
    links = [machine.links[name] for name in SIDES]
    return sum(
        float(link.inertia_diagonal[2]) + link.mass_kg * (link.com_m[0] ** 2 + link.com_m[1] ** 2)
        for link in links
    )


class JawDrive:
    """Moves the jaws towards an angle and keeps pressing."""

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        machine: Machine,
        settings: PhysicsSettings,
    ) -> None:
        self._model, self._data, self._machine, self._settings = model, data, machine, settings
        self._id = model.actuator(machine.jaw.name).id
        self._joint = data.joint(machine.jaw.name)
        self._torque_s = jaw_inertia(machine) / float(model.opt.timestep)  # [N·m] for 1 rad/s
        self._last_rad_s = 0.0
        self._last_nm = 0.0
        self._share = 1.0
        self._interrupted_rad: float | None = None
        self.press(self.position_rad, settings.grip_force_n)

    @property
    def position_rad(self) -> float:
        """Angle of the jaws [rad]."""
        return float(self._joint.qpos[0])

    @property
    def velocity_rad_s(self) -> float:
        """Opening speed of the jaws [rad/s]."""
        return float(self._joint.qvel[0])

    @property
    def effort_nm(self) -> float:
        """Torque of the drive on both jaws about their pivots [N·m]; negative closes."""
        return float(self._data.actuator_force[self._id])

    def press(self, target_rad: float, force_n: float) -> None:
        """Move towards an angle [rad] with at most a force [N] at each tip."""
        self._target_rad, self._interrupted_rad = target_rad, None
        torque = 2 * force_n * self._machine.gripper.tip_radius_m  # one drive moves both tips
        self._torque = torque
        self._limit()

    def weaken(self, share: float) -> None:
        """Have only a share of the commanded torque from now on; 1 is all of it."""
        self._share = share
        self._limit()

    def _limit(self) -> None:
        torque = self._share * self._torque
        self._model.actuator_forcerange[self._id] = (-torque, torque)

    def keep(self) -> KeptJaws:
        """Return what the next step depends on besides the state of the simulation."""
        return {
            "target_rad": self._target_rad,
            "torque_nm": self._torque,
            "share": self._share,
            "last_nm": self._last_nm,
            "last_rad_s": self._last_rad_s,
        }

    def restore(self, kept: KeptJaws) -> None:
        """Take back what `keep` returned."""
        self._target_rad, self._torque, self._share = (
            kept["target_rad"],
            kept["torque_nm"],
            kept["share"],
        )
        self._last_nm, self._last_rad_s = kept["last_nm"], kept["last_rad_s"]
        self._limit()

    def drive(self) -> None:
        """Set the torque of this step.

        It is the last one, changed by what brings the speed of the jaws nearer to the commanded
        one, and not beyond it: jaws that are held back get more until the force is full.
        """
        top = self._machine.jaw.max_velocity
        wanted = self._settings.jaw_stiffness * (self._target_rad - self.position_rad)
        speed = self.velocity_rad_s
        missing = min(max(wanted, -top), top) - speed - (speed - self._last_rad_s)
        limit = float(self._model.actuator_forcerange[self._id, 1])
        torque = self._last_nm + _STEP_SHARE * self._torque_s * missing
        self._last_nm = min(max(torque, -limit), limit)
        self._last_rad_s = speed
        self._data.ctrl[self._id] = self._last_nm

    def hold(self) -> None:
        """Hold jaws that move freely where they are; jaws that press on something keep pressing.

        Pressing takes more than half of the force that was commanded, and free motion far less:
        hundreds of N·m of up to 90 kN·m.
        """
        limit_nm = float(self._model.actuator_forcerange[self._id, 1])
        if abs(self.effort_nm) < _FREE_SHARE * limit_nm and self._interrupted_rad is None:
            self._interrupted_rad, self._target_rad = self._target_rad, self.position_rad

    def go_on(self) -> None:
        """Move on towards the angle that `hold` interrupted."""
        if self._interrupted_rad is not None:
            self._target_rad, self._interrupted_rad = self._interrupted_rad, None
