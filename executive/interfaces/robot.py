"""The machine: real, simulated, or replayed."""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import Field

from executive.interfaces.declaration import PluginSettings
from executive.interfaces.plugin import Plugin
from executive.messages.command import Command
from executive.messages.observation import Observation


class RobotSettings(PluginSettings):
    """Settings of every robot backend."""

    model: str = Field("m545", description="Folder under robot_models, or a path to one.")
    ground: Literal["soil", "rock"] = Field(
        "soil",
        description="What the machine stands on: soil, into which the teeth of its jaws may be "
        "pressed as far as its robot.yaml says (`digs_m`), or rock, on which grasps, motion and "
        "placing keep them above the ground.",
    )

    # Whether the machine is simulated: on the wall clock it then lives in a process of its own.
    is_simulated: ClassVar[bool] = False

    @property
    def may_tip(self) -> bool:
        """Whether the machine stands free where its file does not say so."""
        return False

    @property
    def support_n_m(self) -> float | None:
        """Stiffness of each support of a machine that may tip [N/m]; None if that is its file's."""
        return None

    @property
    def legs_s(self) -> float:
        """How long it takes at most to raise the legs, or to stand on them [s]; 0: its file's."""
        return 0.0


class Robot(Plugin, ABC):
    """Measures and moves. Its settings class derives from RobotSettings."""

    capability = "robot"

    # Kinds of the machine's sensors that the backend does not have, and `efforts` if its joint
    # samples have none: nobody waits for them, or judges by them.
    lacks: frozenset[str] = frozenset()

    # Whether the machine lives by its own clock, whoever reads: the kit then reads at the times
    # that it names, and does not ask for the same bytes twice.
    has_own_clock: ClassVar[bool] = False

    # Whether its sensors are ideal: equal samples in a row are then no sign of a stuck sensor.
    is_ideal: bool = False

    @abstractmethod
    def read(self, until_s: float) -> Sequence[Observation]:
        """Return what was measured since the last call and has arrived by a machine time [s].

        Machine time begins with the mission, and is the time of the stamps. Mission time stands
        still in a pause; machine time does not. A simulated robot advances its world to it.

        Raises:
            RobotError: If the machine does not answer.
        """

    @abstractmethod
    def command(self, command: Command) -> None:
        """Take a command; it replaces an earlier one of its kind.

        Raises:
            RobotError: If the machine refuses, with the reason, such as a joint limit; and if a
                safe stop is latched and the command would move it.
        """

    @abstractmethod
    def resume(self) -> None:
        """Go on along the path that `stop` interrupted; nothing if it interrupted none.

        A second stop gives the path up: nothing is left to go on along then.
        """

    def behind_s(self) -> float:
        """Return by how much the machine will be late on its path if mission time goes on now [s].

        Accelerating after a `resume` may lose more time than braking before it has gained, since
        mission time stood still. Mission time goes on when this is 0 or less. By default it is 0.
        """
        return 0.0

    def latest_s(self) -> float:
        """Return the latest machine time that it can be now [s].

        The clock of a simulation that is too slow for its computer falls behind the wall clock, and
        the mission's waits for it. A real machine's does not: infinity, as by default.
        """
        return math.inf

    def zero_s(self) -> float:
        """Return what the machine's own clock showed when the mission began [s].

        By default it is 0: the machine's clock is that of the mission.
        """
        return 0.0

    def taken_up_s(self, cut_off_s: float) -> float:
        """Return the machine time at which a mission that was cut off goes on [s].

        Args:
            cut_off_s: Machine time at which its last tick ended [s].

        Returns:
            That time, unless the machine has lived on: then its own; called after `restore`.
        """
        return cut_off_s

    @abstractmethod
    def stop(self) -> None:
        """Slow down along the present path within the limits, and hold; the jaws keep pressing."""

    def address(self) -> str:
        """Return where a supervisor can connect with the machine and stop it.

        That is an address of the robot wire, such as `unix:/run/machine.sock`. It is empty for a
        machine that nobody but this object can stop.
        """
        return ""

    @abstractmethod
    def safe_stop(self, reason: str) -> None:
        """Stop, give the path up, and refuse every command that moves until `reset`.

        Jaws that press on something keep pressing, and jaws that move freely hold. A second safe
        stop keeps the first reason.
        """

    @abstractmethod
    def reset(self) -> None:
        """Take commands again after a safe stop; nothing moves by it.

        Raises:
            RobotError: If the machine still moves, or the cause persists.
        """

    @abstractmethod
    def latched(self) -> str:
        """Return why commands are refused; empty while they are taken."""
