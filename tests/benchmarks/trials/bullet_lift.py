"""The same lift of a stone by the free gripper in another physics engine, Bullet.

Geometry, masses, drives and coefficients of contact are those of `SimulatedLift`. What is Bullet's
own: contacts are hard and solved by sequential impulses with a friction pyramid, where MuJoCo's are
compliant and convex with an elliptic cone. Rolling friction and the soil's compliance are left out.
"""

from dataclasses import dataclass, field
from functools import cache

import numpy as np
import pybullet
from executive_plugins.grasping.simulated_lift import FALLEN_M
from executive_plugins.physics.surface import ContactModel
from pybullet_utils.bullet_client import BulletClient

from executive.arrays import Float
from executive.geometry.convex import volume_and_centroid
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import angle_between, quaternion_wxyz
from executive.machine.gravity import GRAVITY_M_S2
from executive.machine.gripper import SIDES, Gripper

_TIMESTEP_S, _ITERATIONS = 0.002, 200
_CLOSE_S, _LIFT_S, _HOLD_S, _LIFT_M = 1.0, 1.0, 0.3, 0.4
_SLACK_RAD = 0.04
_ARM_MASS_KG, _ARM_FORCE_N = 1500.0, 1e6
_ARM_M = 0.5
_MARGIN_M = 0.001
_JAW_SPEED_RAD_S = 1.0
_GROUND = 0  # the first body
_JAW_INERTIA = (30.0, 60.0, 60.0)
_PALM = 3  # the link after the three slides of the arm
_NO_TURN = (0.0, 0.0, 0.0, 1.0)


class BulletLift:
    """Closes the jaws and lifts one stone, on level ground."""

    def __init__(self, gripper: Gripper, hull: Float, mass_kg: float) -> None:
        """Prepare lifts of one stone; `hull` is in the frame of the poses [m], shape (N, 3)."""
        self._gripper, self._hull, self._mass_kg = gripper, hull, mass_kg
        _, self._centroid = volume_and_centroid(hull)

    def slip_m(self, T_plan_gripper: Float, jaw_rad: float, contact: ContactModel) -> float:
        """Return shift plus turn at half a metre of the stone in the jaws [m], at most 0.5.

        Args:
            T_plan_gripper: Pose of the gripper at the grasp, shape (4, 4).
            jaw_rad: Jaw angle from which the jaws close [rad].
            contact: The contacts.
        """
        engine = _engine()
        engine.resetSimulation()
        engine.setTimeStep(_TIMESTEP_S)
        engine.setPhysicsEngineParameter(numSolverIterations=_ITERATIONS)
        stone = self._add_stone(engine, contact)
        machine = self._add_gripper(engine, T_plan_gripper, jaw_rad, contact)
        self._drive(engine, machine, 0.0)
        self._step(engine, stone, _CLOSE_S)
        held = _stone_in_palm(engine, machine, stone)
        for fraction in np.linspace(0.0, 1.0, int(_LIFT_S / _TIMESTEP_S)):
            self._drive(engine, machine, _LIFT_M * fraction**2 * (3 - 2 * fraction))
            self._step(engine, stone, _TIMESTEP_S)
        self._step(engine, stone, _HOLD_S)
        lifted = _stone_in_palm(engine, machine, stone)
        shift_m = float(np.linalg.norm(lifted[:3, 3] - held[:3, 3]))
        return min(shift_m + _ARM_M * angle_between(held[:3, :3], lifted[:3, :3]), FALLEN_M)

    def _step(self, engine: BulletClient, stone: int, span_s: float) -> None:
        """Step; only the stone has weight, as the arm carries that of the gripper."""
        weight = (0.0, 0.0, -GRAVITY_M_S2 * self._mass_kg)
        for _ in range(max(1, round(span_s / _TIMESTEP_S))):
            at, _ = engine.getBasePositionAndOrientation(stone)
            engine.applyExternalForce(stone, -1, weight, at, engine.WORLD_FRAME)
            engine.stepSimulation()

    def _drive(self, engine: BulletClient, machine: int, raised_m: float) -> None:
        for slide, target in enumerate((0.0, 0.0, raised_m)):
            engine.setJointMotorControl2(
                machine,
                slide,
                engine.POSITION_CONTROL,
                targetPosition=target,
                force=_ARM_FORCE_N,
            )
        torque = self._gripper.tip_force_n * self._gripper.tip_radius_m
        for link in _jaws(engine, machine):
            engine.setJointMotorControl2(
                machine,
                link,
                engine.VELOCITY_CONTROL,
                targetVelocity=-_JAW_SPEED_RAD_S,
                force=torque,
            )

    def _add_stone(self, engine: BulletClient, contact: ContactModel) -> int:
        """Add ground and stone. Bullet multiplies frictions: that of the stone is one."""
        ground = engine.createMultiBody(0.0, engine.createCollisionShape(engine.GEOM_PLANE))
        lowest = float(self._hull[:, 2].min())
        engine.resetBasePositionAndOrientation(ground, (0.0, 0.0, lowest), _NO_TURN)
        corners = (self._hull - self._centroid).tolist()
        shape = engine.createCollisionShape(engine.GEOM_MESH, vertices=corners)
        stone = engine.createMultiBody(self._mass_kg, shape, basePosition=self._centroid.tolist())
        engine.changeDynamics(
            ground,
            -1,
            lateralFriction=contact.soil.friction,
            spinningFriction=contact.soil.torsional_m,
        )
        engine.changeDynamics(stone, -1, lateralFriction=1.0)
        engine.changeDynamics(stone, -1, collisionMargin=_MARGIN_M)
        engine.changeDynamics(stone, -1, linearDamping=0.0, angularDamping=0.0)
        engine.changeDynamics(stone, -1, activationState=engine.ACTIVATION_STATE_DISABLE_SLEEPING)
        return int(stone)

    def _add_gripper(
        self, engine: BulletClient, T_plan_gripper: Float, jaw_rad: float, contact: ContactModel
    ) -> int:
        """Add arm, palm and jaws; each of their convex parts is a link that is fixed to them."""
        gripper = self._gripper
        turned = pose(T_plan_gripper[:3, :3])
        links = [
            _Link(0, engine.JOINT_PRISMATIC, (1, 0, 0)),
            _Link(1, engine.JOINT_PRISMATIC, (0, 1, 0)),
            _Link(2, engine.JOINT_PRISMATIC, (0, 0, 1), mass_kg=_ARM_MASS_KG),
            _Link(3, engine.JOINT_FIXED, mass_kg=gripper.palm_mass_kg, T_parent=turned),
        ]
        for name, side in SIDES.items():
            com = tuple(np.array(gripper.jaw_com_m) * (1.0, side, 1.0))
            T, mass_kg = gripper.T_gripper_jaw(name, 0.0), gripper.jaw_mass_kg
            links.append(_Link(4, engine.JOINT_REVOLUTE, (0, 0, side), mass_kg, T, com))
        solids = (gripper.palm_shapes, *(gripper.links[name].shapes for name in SIDES))
        for parent, shapes in enumerate(solids, 4):
            for shape in shapes:
                corners = shape.vertices.tolist()
                solid = engine.createCollisionShape(engine.GEOM_MESH, vertices=corners)
                links.append(_Link(parent, engine.JOINT_FIXED, solid=solid))
        machine = engine.createMultiBody(
            0.0,
            basePosition=T_plan_gripper[:3, 3].tolist(),
            linkMasses=[link.mass_kg for link in links],
            linkCollisionShapeIndices=[link.solid for link in links],
            linkVisualShapeIndices=[-1] * len(links),
            linkPositions=[link.T_parent[:3, 3].tolist() for link in links],
            linkOrientations=[_xyzw(link.T_parent) for link in links],
            linkInertialFramePositions=[link.com_m for link in links],
            linkInertialFrameOrientations=[_NO_TURN] * len(links),
            linkParentIndices=[link.parent for link in links],
            linkJointTypes=[link.joint for link in links],
            linkJointAxis=[link.axis for link in links],
        )
        for number in range(len(links)):
            engine.changeDynamics(
                machine,
                number,
                lateralFriction=contact.steel.friction,
                spinningFriction=contact.steel.torsional_m,
            )
            # In one call with the margin, the friction would be left as it is.
            engine.changeDynamics(machine, number, collisionMargin=_MARGIN_M)
            engine.setCollisionFilterPair(_GROUND, machine, -1, number, 0)
            for other in range(number):
                engine.setCollisionFilterPair(machine, machine, number, other, 0)
        opened = min(jaw_rad + _SLACK_RAD, gripper.open_rad)
        for link in _jaws(engine, machine):
            engine.resetJointState(machine, link, opened)
            engine.changeDynamics(
                machine,
                link,
                localInertiaDiagonal=_JAW_INERTIA,
                jointLowerLimit=0.0,
                jointUpperLimit=gripper.open_rad + 0.02,
            )
        left, right = _jaws(engine, machine)
        tie = engine.createConstraint(
            machine, left, machine, right, engine.JOINT_GEAR, (0, 0, 1), (0, 0, 0), (0, 0, 0)
        )
        engine.changeConstraint(tie, gearRatio=-1, maxForce=1e7, erp=0.1)
        return int(machine)


@dataclass(frozen=True, slots=True)
class _Link:
    """A link of the gripper; `parent` counts from one, and zero is the base."""

    parent: int
    joint: int
    axis: tuple[float, float, float] = (0, 0, 1)
    mass_kg: float = 0.1
    T_parent: Float = field(default_factory=lambda: np.eye(4))
    com_m: tuple[float, ...] = (0.0, 0.0, 0.0)
    solid: int = -1


@cache
def _engine() -> BulletClient:
    return BulletClient(pybullet.DIRECT)


def _jaws(engine: BulletClient, machine: int) -> list[int]:
    """Return the links of the left and the right jaw: Bullet numbers links depth first."""
    joints = range(engine.getNumJoints(machine))
    return [n for n in joints if engine.getJointInfo(machine, n)[2] == engine.JOINT_REVOLUTE]


def _xyzw(T: Float) -> tuple[float, ...]:
    w, *xyz = quaternion_wxyz(T[:3, :3])
    return (*map(float, xyz), float(w))


def _stone_in_palm(engine: BulletClient, machine: int, stone: int) -> Float:
    """Return the pose of the stone's centre of mass in the palm, shape (4, 4)."""
    state = engine.getLinkState(machine, _PALM, computeForwardKinematics=True)
    at, turn = engine.getBasePositionAndOrientation(stone)
    return inverse(_pose(engine, state[4], state[5])) @ _pose(engine, at, turn)


def _pose(engine: BulletClient, at: Float, xyzw: Float) -> Float:
    return pose(np.reshape(engine.getMatrixFromQuaternion(xyzw), (3, 3)), np.array(at))
