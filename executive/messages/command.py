"""What a robot is told to do."""

from dataclasses import dataclass

from executive.messages.trajectory import JointTrajectory

START_TOLERANCE = (
    0.05  # [rad] or [m]: how far from the arm a trajectory may begin; a robot refuses it beyond
)


@dataclass(frozen=True, slots=True, eq=False)
class Follow:
    """Follow a trajectory from now on; it replaces the one under way."""

    trajectory: JointTrajectory


@dataclass(frozen=True, slots=True)
class MoveJaws:
    """Drive the jaws towards a position and keep pressing.

    Attributes:
        position_rad: Jaw angle; 0 is closed, larger is more open.
        force_n: Largest force at each tip [N].
    """

    position_rad: float
    force_n: float


@dataclass(frozen=True, slots=True)
class SwitchLidars:
    """Start or stop the lidars' measuring."""

    on: bool


Command = Follow | MoveJaws | SwitchLidars
