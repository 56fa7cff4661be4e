"""A machine, read from the `robot.yaml` of its folder, the only source of its geometry."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from importlib.resources import files
from itertools import combinations
from pathlib import Path

import numpy as np
from pydantic import Field, ValidationError, model_validator

from executive.arrays import Float
from executive.errors import ConfigError, did_you_mean
from executive.machine.driving import Driving
from executive.machine.gripper import SIDES, Gripper
from executive.machine.hydraulics import Hydraulics
from executive.machine.joint import Jaw, Joint
from executive.machine.link import Link
from executive.machine.rig import Rig
from executive.machine.stance import Stance
from executive.plain_yaml import read_plain_yaml

_FOLDER = Path(str(files("executive_robot_models")))  # machines that come with the package
FILE = "robot.yaml"


class Machine(Rig):
    """Joints, links, sensors and gripper of one machine."""

    turn_joint: str = Field(description="Joint that turns the cabin.")
    stance: Stance
    driving: Driving | None = Field(None, description="How it drives, if it does.")
    joints: tuple[Joint, ...] = Field(
        min_length=1, description="The arm's joints, from the base to the gripper."
    )
    jaw: Jaw
    hydraulics: Hydraulics | None = Field(
        None, description="Valves and cylinders of the arm; without, it has no hydraulic drive."
    )
    gripper: Gripper
    bodies: dict[str, Link] = Field(description="Links by name, without the gripper's.")
    postures: dict[str, dict[str, float]] = Field(
        description="Named joint positions; at least `scan` and `carry`."
    )
    allowed_collisions: tuple[tuple[str, str], ...] = Field(
        (), description="Pairs of links that may touch, besides neighbours."
    )

    @model_validator(mode="after")
    def _check(self) -> "Machine":
        for before, joint in zip(self.joints, self.joints[1:], strict=False):
            if joint.parent != before.child:
                raise ValueError(
                    f"joint {joint.name} has parent '{joint.parent}'; the chain needs "
                    f"'{before.child}'"
                )
        _known("turn_joint", [self.turn_joint], self.arm_names)
        _known("joints", [n for j in self.joints[:-1] for n in (j.parent, j.child)], self.bodies)
        _known("sensors", [s.link for s in self.sensors.values()], self.links)
        _known(
            "allowed_collisions", [n for pair in self.allowed_collisions for n in pair], self.links
        )
        if self.jaw.open_rad != self.gripper.open_rad:
            raise ValueError(
                f"jaw.open_rad {self.jaw.open_rad} differs from gripper.open_rad "
                f"{self.gripper.open_rad}"
            )
        self._check_postures()
        if self.hydraulics is not None and set(self.hydraulics.displacement) != set(self.arm_names):
            raise ValueError(
                f"hydraulics.displacement must give exactly {', '.join(self.arm_names)}"
            )
        return self

    def _check_postures(self) -> None:
        travelling = () if self.driving is None else (self.driving.posture,)
        for needed in ("scan", "carry", *travelling):
            if needed not in self.postures:
                raise ValueError(f"postures lacks `{needed}`")
        for name, posture in self.postures.items():
            if set(posture) != set(self.arm_names):
                raise ValueError(f"posture {name} must give exactly {', '.join(self.arm_names)}")
            beyond = [j.name for j in self.joints if not j.lower <= posture[j.name] <= j.upper]
            if beyond:
                raise ValueError(f"posture {name} is outside the range of {', '.join(beyond)}")

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """Names of all joints that are measured and driven: the arm's, then the jaw."""
        return (*self.arm_names, self.jaw.name)

    @property
    def gripper_link(self) -> str:
        """Name of the link that carries the jaws; its frame is the gripper's."""
        return self.joints[-1].child

    @cached_property
    def links(self) -> dict[str, Link]:
        """All links by name: the bodies, the gripper's palm, the jaws."""
        return {
            **self.bodies,
            self.gripper_link: self.gripper.palm_link(self.gripper_link),
            **self.gripper.links,
        }

    @cached_property
    def fixed_parents(self) -> dict[str, str]:
        """Parent of each link in the kinematic tree, except for the base."""
        chain = {joint.child: joint.parent for joint in self.joints}
        return chain | dict.fromkeys(SIDES, self.gripper_link)

    @cached_property
    def collision_pairs(self) -> tuple[tuple[str, str], ...]:
        """Pairs of links that must not touch: all but neighbours and those that are allowed to."""
        allowed = {frozenset(pair) for pair in self.allowed_collisions} | {frozenset(SIDES)}
        allowed |= {frozenset(pair) for pair in self.fixed_parents.items()}
        return tuple(pair for pair in combinations(self.links, 2) if frozenset(pair) not in allowed)

    def posture(self, name: str) -> Float:
        """Return the arm's positions of a named posture, in joint order, shape (n,).

        Raises:
            ConfigError: If there is no such posture.
        """
        if name not in self.postures:
            raise ConfigError(
                f"{self.name} has no posture '{name}'{did_you_mean(name, self.postures)}"
            )
        return np.array([self.postures[name][joint] for joint in self.arm_names])

    @property
    def payload_kg(self) -> float:
        """Heaviest load of the gripper [kg]."""
        return self.stance.payload_kg

    @property
    def reach_m(self) -> float:
        """Largest distance of the tips from the turning axis [m]."""
        return self.stance.reach_m

    @cached_property
    def lower(self) -> Float:
        """Lower ends of the arm's joints [rad] or [m], −inf where continuous, shape (n,)."""
        return np.array([joint.lower for joint in self.joints])

    @cached_property
    def upper(self) -> Float:
        """Upper ends of the arm's joints [rad] or [m], inf where continuous, shape (n,)."""
        return np.array([joint.upper for joint in self.joints])

    @cached_property
    def max_velocity(self) -> Float:
        """Largest speeds of the arm's joints [rad/s] or [m/s], shape (n,)."""
        return np.array([joint.max_velocity for joint in self.joints])

    @cached_property
    def max_acceleration(self) -> Float:
        """Largest accelerations of the arm's joints [rad/s²] or [m/s²], shape (n,)."""
        return np.array([joint.max_acceleration for joint in self.joints])

    def stop_s(self, joints: Iterable[str]) -> float:
        """Return the longest time in which a joint comes to rest from its largest speed [s].

        Args:
            joints: Names of the joints; of none, it takes no time.
        """
        times = dict(zip(self.arm_names, self.max_velocity / self.max_acceleration, strict=True))
        times[self.jaw.name] = self.jaw.max_velocity / self.jaw.max_acceleration
        return float(max((times[name] for name in joints), default=0.0))

    @cached_property
    def max_jerk(self) -> Float:
        """Largest jerks of the arm's joints [rad/s³] or [m/s³], shape (n,)."""
        return np.array([joint.max_jerk for joint in self.joints])

    @cached_property
    def loaded_max_velocity(self) -> Float:
        """Largest speeds with a load in the gripper, shape (n,)."""
        return np.array([joint.loaded_max_velocity or joint.max_velocity for joint in self.joints])

    @cached_property
    def loaded_max_acceleration(self) -> Float:
        """Largest accelerations with a load in the gripper, shape (n,)."""
        return np.array(
            [joint.loaded_max_acceleration or joint.max_acceleration for joint in self.joints]
        )


def _known(field: str, names: Iterable[str], known: Iterable[str]) -> None:
    known = list(known)
    for name in names:
        if name not in known:
            raise ValueError(
                f"{field} names '{name}', which the machine lacks{did_you_mean(name, known)}"
            )


def machine_folder(model: str) -> Path:
    """Return the folder of a machine, given the name of a shipped one or a path.

    Raises:
        ConfigError: If neither holds a robot.yaml; the message lists the shipped machines.
    """
    for folder in (_FOLDER / model, Path(model)):
        if (folder / FILE).is_file():
            return folder
    shipped = [path.parent.name for path in sorted(_FOLDER.glob(f"*/{FILE}"))]
    raise ConfigError(
        f"no machine '{model}': neither shipped nor a folder with a "
        f"{FILE}{did_you_mean(model, shipped)}"
    )


def machine_file(model: str) -> Path:
    """Return the path of a machine's robot.yaml.

    Raises:
        ConfigError: If there is no such machine.
    """
    return machine_folder(model) / FILE


@dataclass(frozen=True, slots=True)
class Finding:
    """One mistake in a robot.yaml: the keys that lead to it, its kind, and what is wrong."""

    steps: tuple[str | int, ...]
    kind: str
    message: str


class MachineFileError(ConfigError):
    """A robot.yaml has mistakes; `findings` lists them."""

    def __init__(self, message: str, findings: tuple[Finding, ...] = ()) -> None:
        super().__init__(message)
        self.findings = findings


def load_machine(model: str) -> Machine:
    """Read a machine, given the name of a shipped one or the path of its folder.

    Raises:
        ConfigError: If there is none, or its robot.yaml is wrong; the message names every wrong
            field.
    """
    path = machine_file(model)
    try:
        description = read_plain_yaml(path)
    except ConfigError as error:
        raise MachineFileError(str(error)) from None
    if not isinstance(description, dict):
        raise ConfigError(
            f"{path}: expected a mapping that describes a machine, got {type(description).__name__}"
        )
    try:
        return Machine.model_validate(_with_names(description))
    except ValidationError as error:
        findings = tuple(Finding(e["loc"], e["type"], e["msg"]) for e in error.errors())
        lines = [
            f"{path}: {'.'.join(map(str, one.steps)) or 'machine'}: {one.message}"
            for one in findings
        ]
        raise MachineFileError("\n".join(lines), findings) from None


def _with_names(description: dict[str, object]) -> dict[str, object]:
    named = dict(description)
    for key in ("bodies", "sensors"):
        blocks = description.get(key)
        if isinstance(blocks, dict):
            named[key] = {
                n: {"name": n, **b} if isinstance(b, dict) else b for n, b in blocks.items()
            }
    return named
