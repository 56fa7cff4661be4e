"""What every plugin has in common."""

from collections.abc import Mapping
from typing import ClassVar

from executive.config import NoSettings, Settings


class Plugin:
    """Base of all plugins.

    `__init__(self, settings, …)` stores its arguments only. The parameters after `settings` are
    filled in by name: `machine` (executive.machine.machine.Machine), `rng`
    (numpy.random.Generator), or the name of another capability, whose selected plugin is then
    given. `start` and `close` own resources.
    """

    # Name of the capability that the interface stands for, as mission files write it. Interfaces
    # set it; a plugin has it from its interface.
    capability: ClassVar[str] = ""

    # Whether a mission may select several plugins of the capability, which then run side by side.
    is_plural: ClassVar[bool] = False

    Settings: ClassVar[type[Settings]] = NoSettings

    # Verbs that take long, and the time that a simulated mission charges for one call [s].
    latency_s: ClassVar[Mapping[str, float]] = {}

    # Whether a copy in a worker process, made from the same settings, gives the same answers. Verbs
    # of a plugin that says so may run beside the tick; the others are computed within it.
    is_stateless: ClassVar[bool] = False

    # Types of observations that the plugin takes besides those that its interface has verbs for;
    # each is handed to `take` in order of its stamp.
    takes: ClassVar[tuple[type, ...]] = ()

    def take(self, observation: object) -> None:
        """Take one observation of a type that `takes` names; by default, do nothing."""

    def start(self) -> None:
        """Acquire resources; called once, before the first verb."""

    def close(self) -> None:
        """Release resources; called once, also after an error."""
