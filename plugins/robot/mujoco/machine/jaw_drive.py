"""The drive of the jaws: one force-limited velocity actuator; the other jaw is coupled to it."""

import mujoco
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings

from executive.machine.machine import Machine

_FREE_SHARE = 0.5  # of the commanded force: jaws that need less move freely
_YIELD = 0.1  # lag behind the speed, over the top speed, at which the force is full


def make_jaw_drive(spec: mujoco.MjSpec, machine: Machine) -> None:
    """Turn the motor of the jaw into a velocity servo."""
    jaw = machine.jaw
    drive = spec.actuator(jaw.name)
    drive.set_to_velocity(kv=jaw.max_effort / (_YIELD * jaw.max_velocity))
    drive.forcelimited = mujoco.mjtLimited.mjLIMITED_TRUE
    drive.forcerange = [-jaw.max_effort, jaw.max_effort]


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

    def keep(self) -> tuple[float, float, float]:
        """Return the target [rad], the commanded torque [N·m] and the share of it that there is."""
        return self._target_rad, self._torque, self._share

    def restore(self, kept: tuple[float, float, float]) -> None:
        """Take back what `keep` returned."""
        self._target_rad, self._torque, self._share = kept
        self._limit()

    def drive(self) -> None:
        """Set the speed of this step."""
        top = self._machine.jaw.max_velocity
        speed = self._settings.jaw_stiffness * (self._target_rad - self.position_rad)
        self._data.ctrl[self._id] = min(max(speed, -top), top)

    def hold(self) -> None:
        """Hold jaws that move freely where they are; jaws that press on something keep pressing.

        Pressing takes more than half of the force that was commanded: the drive then lags behind
        its speed by as much as it does when something resists.
        """
        limit_nm = float(self._model.actuator_forcerange[self._id, 1])
        if abs(self.effort_nm) < _FREE_SHARE * limit_nm and self._interrupted_rad is None:
            self._interrupted_rad, self._target_rad = self._target_rad, self.position_rad

    def go_on(self) -> None:
        """Move on towards the angle that `hold` interrupted."""
        if self._interrupted_rad is not None:
            self._target_rad, self._interrupted_rad = self._interrupted_rad, None
