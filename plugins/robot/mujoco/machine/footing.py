"""What a simulated machine stands on: welded to the ground, on its wheels, or on its legs."""

from typing import Never, TypedDict

import mujoco
from executive_plugins.robot.base_driver import KeptBase
from executive_plugins.robot.mujoco.machine.legs import Legs
from executive_plugins.robot.mujoco.machine.undercarriage import KeptUndercarriage, Undercarriage
from executive_plugins.robot.mujoco.machine.wheels import HeightAt, Wheels
from executive_plugins.robot.mujoco.physics_settings import LegSettings

from executive.arrays import Float
from executive.errors import RobotError
from executive.machine.machine import Machine
from executive.messages.command import Drive


class KeptFooting(TypedDict):
    """The state of what bears the machine, as far as the simulation's own state lacks it."""

    wheels: KeptBase | None
    undercarriage: KeptUndercarriage | None


class Footing:
    """A chassis that is welded to the ground; the others derive from it.

    Attributes:
        legs: The legs that the machine stands on, or None if it stands on none.
        wheels: The wheels that it drives on, or None if it does not drive.
    """

    legs: Legs | None = None
    wheels: Wheels | None = None

    @property
    def is_moving(self) -> bool:
        """Whether the chassis or a leg moves."""
        return False

    def check_standing(self) -> None:
        """Let a motion of the arm pass only while the machine stands.

        Raises:
            RobotError: If it does not.
        """

    def command(self, drive: Drive, arm: Float, *, arm_moves: bool) -> None:
        """Drive; see `BaseDriver.command`.

        Raises:
            RobotError: If the machine does not drive, or the command is refused.
        """
        _refuse()

    def stop(self) -> None:
        """Brake."""

    def give_up(self) -> None:
        """Brake, and move nothing until `go_on` or the next command."""

    def go_on(self) -> None:
        """Go on after `give_up`."""

    def advance(self, dt_s: float) -> None:
        """Advance by one integration step; call it before the step."""

    def watch(self) -> None:
        """Look how the machine stands, at the end of each control step.

        Raises:
            RobotError: If it has tipped over.
        """

    def keep(self) -> KeptFooting:
        """Return the state: a resumed machine goes on as it was."""
        return {"wheels": None, "undercarriage": None}

    def restore(self, kept: KeptFooting) -> None:
        """Take back what `keep` returned."""


class OnWheels(Footing):
    """A chassis on its wheels alone, which yield nowhere."""

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, machine: Machine, height_at: HeightAt
    ) -> None:
        self._rolling = self.wheels = Wheels(model, data, machine, height_at)

    @property
    def is_moving(self) -> bool:
        return self._rolling.driver.is_moving

    def check_standing(self) -> None:
        self._rolling.driver.check_at_rest()

    def command(self, drive: Drive, arm: Float, *, arm_moves: bool) -> None:
        self._rolling.driver.command(drive, arm, arm_moves=arm_moves)

    def stop(self) -> None:
        self._rolling.driver.stop()

    def give_up(self) -> None:
        self._rolling.driver.stop()

    def advance(self, dt_s: float) -> None:
        self._rolling.advance(dt_s)

    def keep(self) -> KeptFooting:
        return {"wheels": self._rolling.driver.keep(), "undercarriage": None}

    def restore(self, kept: KeptFooting) -> None:
        if kept["wheels"] is not None:
            self._rolling.driver.restore(kept["wheels"])


class OnLegs(Footing):
    """A chassis on its legs; a machine that drives raises them for it."""

    def __init__(
        self,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        machine: Machine,
        height_at: HeightAt,
        settings: LegSettings,
    ) -> None:
        self._bearing = self.legs = Legs(model, data, machine)
        self._under: Undercarriage | None = None
        if machine.driving is not None:
            self.wheels = Wheels(model, data, machine, height_at)
            self._under = Undercarriage(machine, self.legs, self.wheels, settings)

    @property
    def is_moving(self) -> bool:
        return self._under is not None and self._under.is_moving

    def check_standing(self) -> None:
        if self._under is not None:
            self._under.check_standing()

    def command(self, drive: Drive, arm: Float, *, arm_moves: bool) -> None:
        if self._under is None:
            _refuse()
        self._under.command(drive, arm, arm_moves=arm_moves)

    def stop(self) -> None:
        if self._under is not None:
            self._under.stop()

    def give_up(self) -> None:
        if self._under is not None:
            self._under.give_up()

    def go_on(self) -> None:
        if self._under is not None:
            self._under.go_on()

    def advance(self, dt_s: float) -> None:
        if self._under is not None:
            self._under.advance(dt_s)
        self._bearing.weigh()

    def watch(self) -> None:
        if self._under is None or self._under.stands:
            self._bearing.watch()

    def keep(self) -> KeptFooting:
        under = None if self._under is None else self._under.keep()
        return {"wheels": None, "undercarriage": under}

    def restore(self, kept: KeptFooting) -> None:
        if self._under is not None and kept["undercarriage"] is not None:
            self._under.restore(kept["undercarriage"])


def _refuse() -> Never:
    raise RobotError(
        "the chassis is fixed to its place: set robot.base to on_legs or on_wheels, and give "
        "driving in the machine's robot.yaml"
    )
