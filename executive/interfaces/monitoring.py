"""Monitoring: joint samples to verdicts about the held stone."""

from abc import ABC, abstractmethod

from executive.interfaces.plugin import Plugin
from executive.messages.ground_below import GroundBelow
from executive.messages.joints import JointSample
from executive.messages.verdict import Verdict
from executive.messages.weight import Weight


class Monitor(Plugin, ABC):
    """Watch a held stone (Mascaro 2020, Sec. 6.3). It sees every joint sample, held or not."""

    capability = "monitoring"
    is_plural = True

    def payload_kg(self, sample: JointSample) -> float | None:
        """Return the mass in the jaws [kg] of a machine at rest; None if it cannot be told."""
        return None

    def weight(self) -> Weight | None:
        """Return the mass of the stone of this or the last hold, as weighed while it was carried;
        None if it was not.
        """
        return None

    def is_carried(self) -> bool:
        """Return whether the stone of this or the last hold was found to hang: `begin_carry`."""
        return False

    def standing(self) -> float | None:
        """Return the probability that the ground carries what is held, of the newest samples and
        also of a machine that moves; None if it cannot be told.
        """
        return None

    @abstractmethod
    def begin_hold(self) -> None:
        """Watch from now on: the jaws have closed on a stone."""

    def begin_carry(self) -> None:
        """The stone hangs: it was weighed off the ground, and does not settle in the jaws any more.

        A tree without a trial lift never calls it.
        """
        return None

    def carry_over(self, below: GroundBelow) -> None:
        """Take what is below the stone of this hold on its way: higher up nothing carries it.

        It comes after `begin_carry`, where the surroundings are known.
        """
        return None

    @abstractmethod
    def end_hold(self) -> None:
        """Watch no more: the stone is to be released."""

    @abstractmethod
    def update(self, sample: JointSample) -> Verdict | None:
        """Take one joint sample, at each tick and in order of stamps; it must be fast.

        Returns:
            A verdict at the moment when trouble is recognised, with the monitor's installed name;
            None otherwise. Once a hold; only a fall may follow a slip. A sample twice or out of
            order changes nothing.
        """
