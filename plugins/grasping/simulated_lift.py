"""A simulated lift: the known stone, the polyhedral gripper and gravity in a small MuJoCo world.

Analytic force closure from the normals of a stone predicts poorly whether an angular gripper lifts
it. A simulated lift of the hull of the seen points predicts it well and takes about 40 ms. It uses
only the planning cloud and the machine's description.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from executive_plugins.physics.contact import apply_contact
from executive_plugins.physics.surface import ContactModel

from executive.arrays import Float
from executive.geometry.pose import pose
from executive.geometry.rotation import angle_between, exp_so3, quaternion_wxyz
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.gripper import SIDES, Gripper

_TIMESTEP_S = 0.004
_CLOSE_S, _LIFT_S, _HOLD_S = 1.0, 1.0, 0.3
_LIFT_M = 0.4
_SLACK_RAD = 0.04  # the jaws start this much wider than the given angle
_STILL_RAD_S = 2e-3
_MESH = mujoco.mjtGeom.mjGEOM_MESH
_STONE, _GRIPPER, _GROUND = 1, 2, 4  # contact groups; gripper and ground do not collide
_ARM_MASS_KG = 1500.0  # effective mass of the arm at the gripper
_ARM_STIFFNESS = 2e6  # stiffness of its servos at the gripper [N/m]
LIFTED_M = 0.2  # a stone that slips more is lost, or will be
OPENED_RAD = 0.15  # the jaws start this much wider than planned, to allow for the errors
FALLEN_M = 0.5  # slip at which a stone counts as fallen
_ARM_M = 0.5  # a turn counts by the motion that it causes at this distance from the centre
_JAW_INERTIA = (30.0, 60.0, 60.0)


@dataclass(frozen=True, slots=True)
class Lifted:
    """Result of a simulated lift.

    Attributes:
        shift_m: How far the stone moved in the gripper, from closed to lifted [m].
        turn_rad: How far it turned there [rad].
        drag_m: How far the closing jaws moved it on the ground before; its turn counts at half a
            metre from the centre [m].
    """

    shift_m: float
    turn_rad: float
    drag_m: float

    @property
    def slip_m(self) -> float:
        """Shift plus the turn at half a metre from the centre, at most 0.5 m [m].

        A stone that slips 0.5 m or more has fallen.
        """
        return min(self.shift_m + _ARM_M * self.turn_rad, FALLEN_M)


class SimulatedLift:
    """Closes the jaws and lifts, in the frame of the planning cloud."""

    def __init__(self, gripper: Gripper, hull: Float, ground_normal: Float, mass_kg: float) -> None:
        """Prepare simulated lifts of one stone.

        Args:
            gripper: The gripper.
            hull: Points whose convex hull is the stone [m], shape (N, 3).
            ground_normal: Unit normal of the ground, which touches the hull, shape (3,).
            mass_kg: Mass of the stone.
        """
        self._gripper, self._hull, self._up = gripper, hull, ground_normal
        self._mass_kg = mass_kg

    def lift(self, T_plan_gripper: Float, jaw_rad: float, contact: ContactModel) -> Lifted:
        """Close the jaws, lift, and return how the stone moved in the jaws.

        Args:
            T_plan_gripper: Pose of the gripper at the grasp, shape (4, 4).
            jaw_rad: Jaw angle just outside the stone, from which the jaws close [rad].
            contact: The contacts that are assumed.
        """
        model = self._world(T_plan_gripper, contact)
        data = mujoco.MjData(model)
        opened = min(jaw_rad + _SLACK_RAD, self._gripper.open_rad)
        for name in SIDES:
            data.joint(name).qpos[0] = opened
        self._close(model, data)
        held, stone = _stone_in_palm(data), data.body("stone")
        turned_rad = angle_between(np.eye(3), stone.xmat.reshape(3, 3))
        # The body of the stone was at the origin before the jaws closed.
        drag_m = float(np.linalg.norm(stone.xpos)) + _ARM_M * turned_rad
        for fraction in np.linspace(0.0, 1.0, int(_LIFT_S / _TIMESTEP_S)):
            data.ctrl[:3] = self._up * _LIFT_M * fraction**2 * (3 - 2 * fraction)
            mujoco.mj_step(model, data)
        mujoco.mj_step(model, data, nstep=int(_HOLD_S / _TIMESTEP_S))
        lifted = _stone_in_palm(data)
        shift = float(np.linalg.norm(lifted[:3, 3] - held[:3, 3]))
        return Lifted(shift, angle_between(held[:3, :3], lifted[:3, :3]), drag_m)

    def _close(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        data.ctrl[3] = -1.0
        for step in range(int(_CLOSE_S / _TIMESTEP_S)):
            mujoco.mj_step(model, data)
            if step > 25 and abs(data.joint("jaw_left").qvel[0]) < _STILL_RAD_S:
                return

    def _world(self, T_plan_gripper: Float, contact: ContactModel) -> mujoco.MjModel:
        spec = mujoco.MjSpec()
        spec.option.timestep = _TIMESTEP_S
        spec.option.gravity = [0.0, 0.0, -GRAVITY_M_S2]
        self._add_stone(spec)
        self._add_gripper(spec, T_plan_gripper)
        apply_contact(spec, contact)
        return spec.compile()

    def _add_stone(self, spec: mujoco.MjSpec) -> None:
        lowest = self._hull[np.argmin(self._hull @ self._up)]
        quaternion = np.zeros(4)
        mujoco.mju_quatZ2Vec(quaternion, np.ascontiguousarray(self._up))
        plane = mujoco.mjtGeom.mjGEOM_PLANE
        spec.worldbody.add_geom(
            type=plane,
            size=[9, 9, 1],
            pos=lowest,
            quat=quaternion,
            contype=_GROUND,
            conaffinity=_STONE,
        )
        stone = spec.worldbody.add_body(name="stone")
        stone.add_freejoint()
        spec.add_mesh(name="stone", uservert=self._hull.ravel())
        stone.add_geom(
            type=_MESH,
            meshname="stone",
            mass=self._mass_kg,
            contype=_STONE,
            conaffinity=_GRIPPER | _GROUND,
        )

    def _add_gripper(self, spec: mujoco.MjSpec, T_plan_gripper: Float) -> None:
        carriage = _solid(spec.worldbody, "carriage", np.eye(4), _ARM_MASS_KG, np.full(3, 500.0))
        carriage.pos = T_plan_gripper[:3, 3]
        for name, axis in zip("xyz", np.eye(3), strict=True):
            carriage.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
            servo = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            servo.set_to_position(
                kp=_ARM_STIFFNESS, kv=2 * np.sqrt(_ARM_STIFFNESS * 2 * _ARM_MASS_KG)
            )
        turned = T_plan_gripper.copy()
        turned[:3, 3] = 0.0
        palm = _solid(carriage, "palm", turned, self._gripper.palm_mass_kg, np.full(3, 60.0))
        _add_hulls(spec, palm, [shape.vertices for shape in self._gripper.palm_shapes])
        for name, side in SIDES.items():
            jaw = _solid(
                palm,
                name,
                self._gripper.T_gripper_jaw(name, 0.0),
                self._gripper.jaw_mass_kg,
                _JAW_INERTIA,
            )
            jaw.ipos = np.array(self._gripper.jaw_com_m) * (1.0, side, 1.0)
            joint = jaw.add_joint(
                name=name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0.0, 0.0, side]
            )
            joint.limited = mujoco.mjtLimited.mjLIMITED_TRUE
            joint.range = [0.0, np.degrees(self._gripper.open_rad) + 1.0]
            _add_hulls(spec, jaw, [shape.vertices for shape in self._gripper.links[name].shapes])
        spec.add_exclude(bodyname1="jaw_left", bodyname2="jaw_right")
        tie = spec.add_equality(
            name="tie", type=mujoco.mjtEq.mjEQ_JOINT, objtype=mujoco.mjtObj.mjOBJ_JOINT
        )
        tie.name1, tie.name2 = "jaw_right", "jaw_left"
        tie.data[:5] = (0.0, 1.0, 0.0, 0.0, 0.0)
        # One drive moves both tips.
        torque = 2 * self._gripper.tip_force_n * self._gripper.tip_radius_m
        drive = spec.add_actuator(name="jaw", target="jaw_left", trntype=mujoco.mjtTrn.mjTRN_JOINT)
        drive.set_to_velocity(kv=20 * torque)
        drive.forcelimited, drive.forcerange = mujoco.mjtLimited.mjLIMITED_TRUE, [-torque, torque]


def _solid(
    parent: mujoco.MjsBody,
    name: str,
    T_parent: Float,
    mass_kg: float,
    inertia: Float | tuple[float, ...],
) -> mujoco.MjsBody:
    """Add a body whose weight the arm compensates."""
    body = parent.add_body(
        name=name, pos=T_parent[:3, 3], quat=quaternion_wxyz(T_parent[:3, :3]), gravcomp=1.0
    )
    body.explicitinertial, body.mass, body.inertia = True, mass_kg, inertia
    body.ipos = [0.0, 0.0, 0.0]
    return body


def _add_hulls(spec: mujoco.MjSpec, body: mujoco.MjsBody, hulls: list[Float]) -> None:
    for i, hull in enumerate(hulls):
        name = f"{body.name}_{i}"
        spec.add_mesh(name=name, uservert=np.ravel(hull))
        body.add_geom(type=_MESH, meshname=name, contype=_GRIPPER, conaffinity=_STONE)


def _stone_in_palm(data: mujoco.MjData) -> Float:
    stone, palm = data.body("stone"), data.body("palm")
    R = palm.xmat.reshape(3, 3).T
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R @ stone.xmat.reshape(3, 3), R @ (stone.xipos - palm.xpos)
    return T


def drawn_offset(rng: np.random.Generator, shift_m: float, turn_rad: float) -> Float:
    """Return where the arm brings a gripper, seen from where it shall be, shape (4, 4).

    Args:
        rng: Draws it.
        shift_m: Largest shift along each axis [m].
        turn_rad: Largest component of the turn about each axis [rad].
    """
    turn, shift = rng.uniform(-turn_rad, turn_rad, 3), rng.uniform(-shift_m, shift_m, 3)
    return pose(exp_so3(turn), shift)
