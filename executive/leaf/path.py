"""The output of leaves that plan one motion and nothing else."""

from dataclasses import dataclass

from executive.messages.trajectory import JointTrajectory


@dataclass(frozen=True, slots=True)
class PathPlanned:
    """A collision-free path.

    Attributes:
        trajectory: Joint positions over time.
    """

    trajectory: JointTrajectory
