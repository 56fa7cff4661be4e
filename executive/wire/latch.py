"""A safe stop that lasts until it is reset."""

from executive.errors import RobotError
from executive.interfaces.robot import Robot


class Latch:
    """Keeps why the machine was stopped; until it is released, nothing may move."""

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self.reason = ""

    def engage(self, reason: str) -> bool:
        """Stop the machine and keep it stopped; return whether it was not stopped already."""
        if self.reason:
            return False
        self.reason = reason
        self._robot.stop()
        return True

    def check(self) -> None:
        """Refuse what moves.

        Raises:
            RobotError: If the stop has not been reset; the message says why it was made.
        """
        if self.reason:
            raise RobotError(f"the machine was stopped: {self.reason}; reset the stop first")

    def release(self, *, is_moving: bool) -> None:
        """Let commands be taken again.

        Raises:
            RobotError: If the machine still moves.
        """
        if self.reason and is_moving:
            raise RobotError("the machine still moves; reset the stop when it is at rest")
        self.reason = ""
