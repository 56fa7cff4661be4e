"""Commands to a robot."""

from dataclasses import dataclass

from executive.messages.trajectory import JointTrajectory

# Largest distance of a trajectory's start from the arm's position [rad] or [m]; a robot refuses a
# trajectory that begins farther off.
START_TOLERANCE = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Follow:
    """Follow a trajectory from now on; it replaces the one that is being followed."""

    trajectory: JointTrajectory


@dataclass(frozen=True, slots=True)
class MoveJaws:
    """Move the jaws towards a position, and hold the force there.

    Attributes:
        position_rad: Jaw angle; 0 is closed, larger is more open.
        force_n: Largest force at each tip [N].
    """

    position_rad: float
    force_n: float


@dataclass(frozen=True, slots=True)
class SwitchLidars:
    """Start or stop the measurements of all lidars."""

    on: bool


Command = Follow | MoveJaws | SwitchLidars
