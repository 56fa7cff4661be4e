"""The servos of the arm, limited in effort.

They are position loops with velocity feed-forward and a slow integral part.
"""

from collections.abc import Mapping
from typing import TypedDict, cast

import mujoco
import numpy as np
from executive_plugins.robot.mujoco.physics_settings import PhysicsSettings

from executive.arrays import Float
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine

_TYPICAL_LOAD = 0.4  # share of the payload for which the gains are computed
_INTEGRAL_S = 0.4  # time constant that compensates the sag under a stone
# Anti-windup limit of the integral part: a multiple of the effort for the payload, and at least a
# share of the effort limit. Without it, an arm that presses on the ground builds up its full effort
# and jumps when the contact ends.
_INTEGRAL_PAYLOADS = 1.3
_INTEGRAL_SHARE = 0.1
_HELD_IMPEDANCE = 0.9999  # of MuJoCo's friction that stands for a shut valve: 1 is without creep


def make_servos(spec: mujoco.MjSpec, machine: Machine, settings: PhysicsSettings) -> None:
    """Turn the motors of the arm into critically damped position servos.

    Damping is part of the actuator, where MuJoCo integrates it implicitly; explicit damping is
    unstable at the wrists.
    """
    omega = settings.servo_rad_s
    for joint, inertia in zip(machine.joints, _reflected_inertia(spec, machine), strict=True):
        servo = spec.actuator(joint.name)
        servo.set_to_position(kp=inertia * omega**2, kv=2 * inertia * omega)
        servo.forcelimited = mujoco.mjtLimited.mjLIMITED_TRUE
        servo.forcerange = [-joint.max_effort, joint.max_effort]


def _reflected_inertia(spec: mujoco.MjSpec, machine: Machine) -> Float:
    """Return the inertia at each joint, shape (n,).

    It is computed in the carrying posture with a typical load between the jaws.
    """
    model = spec.copy().compile()
    data = mujoco.MjData(model)
    q = machine.posture("carry")
    for name, value in zip(machine.arm_names, q, strict=True):
        data.joint(name).qpos = value
    mujoco.mj_forward(model, data)
    M = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M)
    dofs = [model.joint(name).dofadr[0] for name in machine.arm_names]
    J = _load_jacobian(machine, q)
    return np.asarray(M.diagonal()[dofs] + _TYPICAL_LOAD * machine.payload_kg * (J**2).sum(axis=0))


def _load_jacobian(machine: Machine, q_arm: Float) -> Float:
    """Return the linear Jacobian of the grasp centre, shape (3, n)."""
    kinematics = Kinematics(machine)
    J, T = kinematics.jacobian(q_arm), kinematics.gripper(q_arm)
    lever = T[:3, :3] @ machine.gripper.grasp_centre
    return np.asarray(J[:3] + np.cross(J[3:].T, lever).T)


def _integral_limit(machine: Machine) -> Float:
    """Return the largest contribution of the integral part to each effort, shape (n,)."""
    weight = (
        np.abs(_load_jacobian(machine, machine.posture("carry"))[2])
        * machine.payload_kg
        * GRAVITY_M_S2
    )
    limit = np.array([joint.max_effort for joint in machine.joints])
    return np.asarray(np.maximum(_INTEGRAL_PAYLOADS * weight, _INTEGRAL_SHARE * limit))


class _Kept(TypedDict):
    """What the next step depends on, besides the state of the simulation."""

    sag: Float
    shares: Float


class ArmServos:
    """Sends references to the servos, once per physics step."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, machine: Machine) -> None:
        self._data, self._dt_s = data, float(model.opt.timestep)
        self._model, self._names = model, machine.arm_names
        self._max_effort = [joint.max_effort for joint in machine.joints]
        self._ids = np.array([model.actuator(name).id for name in machine.arm_names])
        joints = [model.joint(name) for name in machine.arm_names]
        self._qpos = np.array([joint.qposadr[0] for joint in joints])
        self._dofs = np.array([joint.dofadr[0] for joint in joints])
        kp, kv = model.actuator_gainprm[self._ids, 0], -model.actuator_biasprm[self._ids, 2]
        self._lead_s = kv / kp
        self._sag = np.zeros(len(self._ids))
        self._max_sag = _integral_limit(machine) / kp
        self._shares = np.ones(len(self._ids))  # of its effort that each drive has
        self._holds = [joint.holds_without_pressure for joint in machine.joints]
        self._friction = model.dof_frictionloss[self._dofs].copy()
        self._stiffness = model.dof_solimp[self._dofs].copy()

    def position(self) -> Float:
        """Return the true joint positions of the arm, shape (n,)."""
        return np.array(self._data.qpos[self._qpos])

    def velocity(self) -> Float:
        """Return the true joint velocities of the arm, shape (n,)."""
        return np.array(self._data.qvel[self._dofs])

    def effort(self) -> Float:
        """Return the efforts of the actuators, the weights of the links included, shape (n,)."""
        return np.array(self._data.qfrc_actuator[self._dofs])

    def weaken(self, joint: str, share: float) -> None:
        """Let a joint have only a share of its largest effort from now on; 1 is all of it.

        Of a joint that holds without pressure, the valve at its cylinder (or the brake) shuts when
        all of it is lost. A shut cylinder does no work: it brakes and holds, with at most the
        largest effort, at which its relief valve opens. The pressure sensors are on the other side
        of that valve and measure nothing.
        """
        i = self._names.index(joint)
        self._shares[i] = share
        is_shut = share == 0.0 and self._holds[i]
        dof = self._dofs[i]
        self._model.dof_frictionloss[dof] = self._max_effort[i] if is_shut else self._friction[i]
        self._model.dof_solimp[dof] = self._stiffness[i]
        if is_shut:  # the default friction creeps by 1 cm/s under the arm's weight
            self._model.dof_solimp[dof, :2] = _HELD_IMPEDANCE
        effort = share * self._max_effort[i]
        self._model.actuator_forcerange[self._ids[i]] = (-effort, effort)
        # The drive carries the weight of the links, too; that is no part of the actuator's force.
        number = self._model.joint(joint).id
        self._model.jnt_actfrclimited[number] = share < 1.0
        self._model.jnt_actfrcrange[number] = (-effort, effort)

    def drive(self, position: Float, velocity: Float) -> None:
        """Set the reference position and velocity of this step, each shape (n,)."""
        error = position - self._data.qpos[self._qpos]
        sag = self._sag + error * self._dt_s / _INTEGRAL_S
        self._sag = np.minimum(np.maximum(sag, -self._max_sag), self._max_sag)  # clip, but quick
        self._data.ctrl[self._ids] = position + self._sag + self._lead_s * velocity

    def keep(self) -> Mapping[str, object]:
        """Return what the next step depends on, besides the state of the simulation."""
        return {"sag": self._sag, "shares": self._shares.copy()}

    def restore(self, kept: Mapping[str, object]) -> None:
        """Take back what `keep` returned."""
        own = cast(_Kept, kept)
        self._sag = own["sag"]
        for name, share in zip(self._names, own["shares"], strict=True):
            self.weaken(name, float(share))
