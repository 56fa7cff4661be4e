"""The bodies that carry sensors: what an estimator needs to know of a machine.

Other than a `Machine`, a rig need not have an arm: it also describes a car.
"""

from functools import cached_property

from pydantic import Field

from executive.config import Settings
from executive.machine.joint import Joint
from executive.machine.sensor import Sensor


class Rig(Settings):
    """A chassis, the joints above it, and sensors. Without turn joint the chassis is the cabin."""

    name: str = Field(description="Name of the machine.")
    turn_joint: str | None = Field(None, description="The joint that turns the cabin, if any.")
    joints: tuple[Joint, ...] = Field(
        (), description="The arm's joints, from the base to the gripper."
    )
    sensors: dict[str, Sensor] = Field(description="Sensors by name.")

    @cached_property
    def arm_names(self) -> tuple[str, ...]:
        """Names of the arm's joints, from the base to the gripper."""
        return tuple(joint.name for joint in self.joints)

    @property
    def base_link(self) -> str:
        """Name of the chassis' link."""
        return self.joints[0].parent if self.joints else "base"

    @property
    def cabin_link(self) -> str:
        """Name of the link that the turn joint moves; of the chassis if nothing turns."""
        if self.turn_joint is None:
            return self.base_link
        return self.joints[self.arm_names.index(self.turn_joint)].child

    def sensors_of(self, kind: str) -> tuple[Sensor, ...]:
        """Return the sensors of a kind, in the file's order."""
        return tuple(sensor for sensor in self.sensors.values() if sensor.kind == kind)
