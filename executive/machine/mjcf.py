"""The machine as a generated MuJoCo model, with the names of the machine's description.

The base is welded to the world. The joints' actuators compensate the weight of the machine's own
links (`actgravcomp`), as a valve controller does that knows the arm's masses. The efforts include
this weight, but it does not disturb the tracking.
"""

import mujoco
import numpy as np

from executive.arrays import Float
from executive.geometry.rotation import quaternion_wxyz
from executive.machine.gripper import SIDES
from executive.machine.link import Link
from executive.machine.machine import Machine
from executive.machine.shape import Shape

_HINGE, _SLIDE = mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE
_BOX, _CYLINDER, _MESH = (
    mujoco.mjtGeom.mjGEOM_BOX,
    mujoco.mjtGeom.mjGEOM_CYLINDER,
    mujoco.mjtGeom.mjGEOM_MESH,
)
_IS_LIMITED = {False: mujoco.mjtLimited.mjLIMITED_FALSE, True: mujoco.mjtLimited.mjLIMITED_TRUE}

JAW_TIE = "jaw_tie"  # equality constraint by which the right jaw mirrors the left one


def machine_spec(machine: Machine) -> mujoco.MjSpec:
    """Build the model: bodies, joints, motors named like their joints, and excluded contacts."""
    spec = mujoco.MjSpec()
    spec.modelname = machine.name
    bodies = {
        machine.base_link: _add_body(
            spec, spec.worldbody, machine.links[machine.base_link], np.eye(4)
        )
    }
    for joint in machine.joints:
        body = _add_body(
            spec, bodies[joint.parent], machine.links[joint.child], joint.T_parent_joint
        )
        bodies[joint.child] = body
        kind = _SLIDE if joint.kind == "prismatic" else _HINGE
        _add_joint(body, joint.name, kind, joint.axis, joint.range)
        _add_motor(spec, joint.name, joint.max_effort)
    _add_jaws(spec, bodies[machine.gripper_link], machine)
    _exclude_contacts(spec, machine)
    return spec


def mjcf(machine: Machine) -> str:
    """Return the machine as MJCF text."""
    spec = machine_spec(machine)
    spec.compile()
    return str(spec.to_xml())


def _add_body(
    spec: mujoco.MjSpec, parent: mujoco.MjsBody, link: Link, T_parent_link: Float
) -> mujoco.MjsBody:
    body = parent.add_body(
        name=link.name, pos=T_parent_link[:3, 3], quat=quaternion_wxyz(T_parent_link[:3, :3])
    )
    body.explicitinertial = True
    body.mass, body.ipos, body.inertia = link.mass_kg, link.com_m, link.inertia_diagonal
    body.gravcomp = 1.0
    for i, shape in enumerate(link.shapes):
        _add_geom(spec, body, f"{link.name}_{i}", shape)
    return body


def _add_geom(spec: mujoco.MjSpec, body: mujoco.MjsBody, name: str, shape: Shape) -> None:
    T = shape.T_link_shape
    geom = body.add_geom(name=name, pos=T[:3, 3], quat=quaternion_wxyz(T[:3, :3]))
    if shape.kind == "box":
        geom.type, geom.size = _BOX, np.array(shape.size) / 2
    elif shape.kind == "cylinder":
        geom.type, geom.size = _CYLINDER, [shape.size[0], shape.size[1] / 2, 0.0]
    else:
        spec.add_mesh(name=name, uservert=np.ravel(shape.points_m))
        geom.type, geom.meshname = _MESH, name


def _add_joint(
    body: mujoco.MjsBody,
    name: str,
    kind: mujoco.mjtJoint,
    axis: tuple[float, float, float],
    limits: tuple[float, float] | None,
) -> None:
    joint = body.add_joint(name=name, type=kind, axis=axis)
    joint.limited, joint.actgravcomp = _IS_LIMITED[limits is not None], True
    if limits is not None:
        joint.range = (
            np.array(limits) if kind == _SLIDE else np.degrees(limits)
        )  # MjSpec reads degrees by default


def _add_motor(spec: mujoco.MjSpec, joint: str, max_effort: float) -> None:
    motor = spec.add_actuator(name=joint, target=joint, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    motor.set_to_motor()
    motor.forcelimited, motor.forcerange = _IS_LIMITED[True], [-max_effort, max_effort]


def _add_jaws(spec: mujoco.MjSpec, palm: mujoco.MjsBody, machine: Machine) -> None:
    jaw = machine.jaw
    for name, side in SIDES.items():
        body = _add_body(spec, palm, machine.links[name], machine.gripper.T_gripper_jaw(name, 0.0))
        joint = jaw.name if side > 0 else jaw.mirror_name
        _add_joint(body, joint, _HINGE, (0.0, 0.0, side), (jaw.lower, jaw.upper))
    _add_motor(spec, jaw.name, jaw.max_effort)
    tie = spec.add_equality(
        name=JAW_TIE, type=mujoco.mjtEq.mjEQ_JOINT, objtype=mujoco.mjtObj.mjOBJ_JOINT
    )
    tie.name1, tie.name2 = jaw.mirror_name, jaw.name
    tie.data[:5] = (0.0, 1.0, 0.0, 0.0, 0.0)  # mirror = jaw


def _exclude_contacts(spec: mujoco.MjSpec, machine: Machine) -> None:
    checked = {frozenset(pair) for pair in machine.collision_pairs}
    names = list(machine.links)
    for i, first in enumerate(names):
        for second in names[i + 1 :]:
            if frozenset((first, second)) not in checked:
                spec.add_exclude(bodyname1=first, bodyname2=second)
