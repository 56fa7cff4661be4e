"""The latch of a safe stop: commands that move are refused until it is reset."""

from executive.errors import RobotError
from executive.messages.command import Command, LimitStop, SwitchLidars


class Latch:
    """Holds the reason of a safe stop.

    Attributes:
        reason: Why commands are refused; empty while they are taken.
    """

    def __init__(self) -> None:
        self.reason = ""

    def engage(self, reason: str) -> None:
        """Refuse from now on; the first reason is kept."""
        self.reason = self.reason or reason or "no reason was given"

    def release(self, *, is_moving: bool) -> None:
        """Take commands again.

        Raises:
            RobotError: If the machine still moves.
        """
        if self.reason and is_moving:
            raise RobotError("the machine still moves: reset the safe stop when it is at rest")
        self.reason = ""

    def check(self, command: Command) -> None:
        """Let a command pass that moves nothing, or while nothing is latched.

        Raises:
            RobotError: If the command is refused.
        """
        if self.reason and not isinstance(command, SwitchLidars | LimitStop):
            raise RobotError(
                f"{type(command).__name__} is refused: a safe stop is latched ({self.reason}); "
                "reset the robot first"
            )
