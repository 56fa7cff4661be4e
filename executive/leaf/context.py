"""What a leaf may use: plugins, snapshots, jobs, the journal; not the loop, nor the wall clock."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Mapping, Sequence
from pathlib import Path
from typing import ParamSpec, TypeVar

import numpy as np

from executive.arrays import Float
from executive.events.event import Event
from executive.journal import Entry
from executive.leaf.job import Job
from executive.machine.machine import Machine
from executive.messages.base_state import BaseState
from executive.messages.ground_below import GroundBelow
from executive.messages.joints import JointSample
from executive.messages.region import Region
from executive.messages.verdict import Verdict
from executive.messages.weight import Weight

Interface = TypeVar("Interface")
Arguments = ParamSpec("Arguments")
Value = TypeVar("Value")


class Context(ABC):
    """One leaf's view of the mission."""

    @abstractmethod
    def now_s(self) -> float:
        """Return the mission's time [s]."""

    @abstractmethod
    def use(self, interface: Callable[..., Interface]) -> Interface:
        """Return the selected plugin of an interface that the leaf's `needs` names.

        Its short verbs may be called at once; verbs that take long belong into a `job`.

        Args:
            interface: The class, such as `MotionPlanner`; declared as a callable because type
                checkers refuse an abstract class where a `type` is expected.

        Raises:
            ConfigError: If the mission selects none.
        """

    def job(
        self,
        verb: Callable[Arguments, Value],
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> Generator[Job[Value], Value, Value]:
        """Call a verb that takes long and wait for its result without blocking the tick.

        Use it as `plan = yield from self.context.job(motion.move, request)`, where `motion` is what
        `use` returned. What the verb raises is raised where the leaf waits. A leaf's own function
        that computes for long is called in the same way; it takes and returns values alone.
        """
        value: Value = yield self.start(verb, *args, **kwargs)
        return value

    @abstractmethod
    def start(
        self,
        verb: Callable[Arguments, Value],
        *args: Arguments.args,
        **kwargs: Arguments.kwargs,
    ) -> Job[Value]:
        """Start a verb of a plugin, or a leaf's own function, and return its job, for a leaf that
        waits in its own way.
        """

    @abstractmethod
    def rng(self) -> "np.random.Generator":
        """Return a new generator, seeded by the mission's seed, the node's path and the number of
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
    def machine(self) -> Machine:
        """Return the description of the machine."""

    @abstractmethod
    def region(self, name: str) -> Region:
        """Return a region of the mission; settings of the type `RegionName` are checked before.

        Raises:
            ConfigError: If the mission has none of that name; the message names the nearest.
        """

    @abstractmethod
    def slot_places(self) -> Mapping[int, Float]:
        """Return the places of all slots found so far in the mission by number [m], each (3,)."""

    @abstractmethod
    def begin_hold(self) -> None:
        """Tell the monitors that the jaws hold a stone; earlier verdicts are dropped."""

    def begin_carry(self, weight: Weight | None = None) -> None:
        """Tell the monitors that the held stone hangs free.

        Args:
            weight: What it weighed as that was found out; `trial_weight` returns it.
        """
        return None

    def trial_weight(self) -> Weight | None:
        """Return what the held stone weighed as it was found to hang free; None before that."""
        return None

    def carry_over(self, below: GroundBelow) -> None:
        """Tell the monitors what is below the held stone on its way."""
        return None

    @abstractmethod
    def end_hold(self) -> None:
        """Tell the monitors that the stone is about to be released on purpose."""

    @abstractmethod
    def verdicts(self) -> tuple[Verdict, ...]:
        """Return the monitors' verdicts since `begin_hold`, oldest first."""

    def weight(self) -> Weight | None:
        """Return the mass of the stone of this or the last hold, as the monitors weighed it while
        it was carried; None if none did.
        """
        return None

    def is_carried(self) -> bool:
        """Return whether the stone of this or the last hold was found to hang free."""
        return False

    def payload_kg(self) -> float | None:
        """Return the mass in the jaws now [kg], of a machine at rest; None if no monitor tells."""
        return None

    def standing(self) -> float | None:
        """Return the probability that the ground carries what is held; None if no monitor tells."""
        return None

    def is_given_up(self, stone: int) -> bool:
        """Return whether a stone was set aside for a reason that no other attempt can change."""
        return False

    @abstractmethod
    def last_failure(self) -> str:
        """Return why the node before this one under the same parent failed; empty if it did not."""

    def first_failure(self) -> str:
        """Return why the first attempt failed, if the node before this one made several under a
        `retry`; empty if it did not.
        """
        return ""

    @abstractmethod
    def record(self, event: Event) -> None:
        """Write an event into the journal, under this node."""

    @abstractmethod
    def follow_journal(self) -> Callable[[], Sequence[Entry]]:
        """Return a function that returns what was written to the journal since its last call.

        Its first call returns what was written since this one.
        """

    @abstractmethod
    def folder(self) -> Path:
        """Return the folder of the run, for files that belong to it."""

    @abstractmethod
    def show(self, entity: str, value: object) -> None:
        """Hand a value to the viewer."""
