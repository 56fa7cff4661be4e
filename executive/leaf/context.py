"""What a leaf may touch: plugins, snapshots, jobs, the journal; never the loop, the simulator or
the wall clock.
"""

from abc import ABC, abstractmethod
from typing import Any

import numpy as np

from executive.arrays import Float
from executive.leaf.job import Job
from executive.messages.base_state import BaseState
from executive.messages.joints import JointSample
from executive.messages.verdict import Verdict


class Context(ABC):
    """One leaf's view of the mission."""

    @abstractmethod
    def now_s(self) -> float:
        """Return the mission's time [s]."""

    @abstractmethod
    def plugin(self, capability: str) -> Any:
        """Return the selected plugin of a capability that the leaf's `needs` names, to call a short
        verb at once.
        """

    @abstractmethod
    def job(self, capability: str, verb: str, *args: Any) -> Job:
        """Start a long verb; the leaf yields the job and is resumed with its result."""

    @abstractmethod
    def rng(self) -> np.random.Generator:
        """Return a fresh generator, seeded by the mission's seed, the node's path and the number of
        such calls.
        """

    @abstractmethod
    def state(self) -> BaseState:
        """Return the newest state estimate."""

    @abstractmethod
    def joints(self) -> JointSample:
        """Return the newest joint sample."""

    @abstractmethod
    def arm(self) -> Float:
        """Return the arm's joint positions [rad] or [m] in the machine's order, shape (n,)."""

    @abstractmethod
    def gripper(self) -> Float:
        """Return T_map_gripper from the newest state and joints, shape (4, 4)."""

    @abstractmethod
    def machine(self) -> Any:
        """Return the machine's description (executive.machine.machine.Machine)."""

    @abstractmethod
    def begin_hold(self) -> None:
        """Tell the monitors that the jaws have closed on a stone;
        earlier verdicts are forgotten.
        """

    @abstractmethod
    def end_hold(self) -> None:
        """Tell the monitors that the stone is let go on purpose."""

    @abstractmethod
    def verdicts(self) -> tuple[Verdict, ...]:
        """Return what monitors have said since `begin_hold`, oldest first."""

    @abstractmethod
    def last_failure(self) -> str:
        """Return why the node before this one under the same parent failed; empty if it did not."""

    @abstractmethod
    def note(self, kind: str, **payload: Any) -> None:
        """Write a line into the journal, under this node."""

    @abstractmethod
    def show(self, entity: str, value: object) -> None:
        """Hand a value to the viewer."""
