"""The machine as generated URDF, for kinematics and for other tools."""

from xml.etree import ElementTree as Xml

from executive.machine.gripper import SIDES
from executive.machine.joint import Joint, JointLimits
from executive.machine.link import Link
from executive.machine.machine import Machine
from executive.machine.origin import Origin


def urdf(machine: Machine) -> str:
    """Return the machine as URDF text, with the names of its description and without shapes."""
    robot = Xml.Element("robot", name=machine.name)
    for link in machine.links.values():
        _add_link(robot, link)
    for joint in machine.joints:
        _add_joint(robot, joint)
    for name in SIDES:
        _add_jaw(robot, machine, name)
    for sensor in machine.sensors.values():
        Xml.SubElement(robot, "link", name=sensor.name)
        element = _element(robot, f"{sensor.name}_mount", "fixed", sensor.link, sensor.name)
        _add_origin(element, sensor)
    Xml.indent(robot)
    return Xml.tostring(robot, encoding="unicode")


def _text(*values: float) -> str:
    return " ".join(repr(float(value)) for value in values)


def _add_origin(element: Xml.Element, origin: Origin) -> None:
    Xml.SubElement(element, "origin", xyz=_text(*origin.xyz_m), rpy=_text(*origin.rpy_rad))


def _element(robot: Xml.Element, name: str, kind: str, parent: str, child: str) -> Xml.Element:
    element = Xml.SubElement(robot, "joint", name=name, type=kind)
    Xml.SubElement(element, "parent", link=parent)
    Xml.SubElement(element, "child", link=child)
    return element


def _add_link(robot: Xml.Element, link: Link) -> None:
    inertial = Xml.SubElement(Xml.SubElement(robot, "link", name=link.name), "inertial")
    Xml.SubElement(inertial, "origin", xyz=_text(*link.com_m))
    Xml.SubElement(inertial, "mass", value=_text(link.mass_kg))
    ixx, iyy, izz = (_text(moment) for moment in link.inertia_diagonal)
    Xml.SubElement(inertial, "inertia", ixx=ixx, iyy=iyy, izz=izz, ixy="0", ixz="0", iyz="0")


def _add_joint(robot: Xml.Element, joint: Joint) -> None:
    element = _element(robot, joint.name, joint.kind, joint.parent, joint.child)
    _add_origin(element, joint)
    Xml.SubElement(element, "axis", xyz=_text(*joint.axis))
    ends = {} if joint.range is None else {"lower": _text(joint.lower), "upper": _text(joint.upper)}
    _add_limit(element, joint, ends)


def _add_limit(element: Xml.Element, limits: JointLimits, ends: dict[str, str]) -> None:
    speed, effort = _text(limits.max_velocity), _text(limits.max_effort)
    Xml.SubElement(element, "limit", {"velocity": speed, "effort": effort, **ends})


def _add_jaw(robot: Xml.Element, machine: Machine, name: str) -> None:
    jaw, side = machine.jaw, SIDES[name]
    joint = jaw.name if side > 0 else jaw.mirror_name
    element = _element(robot, joint, "revolute", machine.gripper_link, name)
    x, y = machine.gripper.pivot_m
    Xml.SubElement(element, "origin", xyz=_text(x, side * y, 0))
    Xml.SubElement(element, "axis", xyz=_text(0, 0, side))
    _add_limit(element, jaw, {"lower": _text(jaw.lower), "upper": _text(jaw.upper)})
    if side < 0:
        Xml.SubElement(element, "mimic", joint=jaw.name)
