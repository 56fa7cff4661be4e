"""What every plugin has in common."""

from collections.abc import Mapping
from typing import ClassVar

from executive.config import NoSettings, Settings


class Plugin:
    """Base of all plugins, and what every one of them promises.

    `__init__(self, settings, …)` stores its arguments only. The parameters after `settings` are
    filled in by name: `machine` (executive.machine.machine.Machine), `rng`
    (numpy.random.Generator), or the name of another capability, whose selected plugin is then
    given. `start` and `close` own resources.

    Every verb of every interface keeps these rules, and `executive plugins test` checks them:

    - Units are SI; a name says the frame of an array (`points_map`, `T_map_base`: the pose of the
      base in the map). Shapes are given where the verb or the message is described.
    - Arrays that are handed in are read-only and shared: copy one before writing to a part of it.
      Arrays that are handed out are not written to afterwards.
    - One seed gives one answer, bit for bit: chance comes from the generator that is handed in, and
      time from the stamps. Nothing sleeps, prints, or reads a clock.
    - What can fail for physical reasons is a value: an empty tuple, None, `accepted=False` with a
      reason. An input that holds nothing useful (empty, one point, not finite, of another shape)
      gives such a value or a DataError; no value holds a NaN. Any other exception is a fault of the
      plugin, and ends the mission in a safe stop.
    - Verbs are called within a tick, in one thread, and must be done within a share of it, unless
      `latency_s` names them: those are computed as jobs, beside the tick where `is_stateless`. On
      the wall clock, verbs that `beside_tick` names are called in another thread.
    - Answers, inputs and settings can be pickled, for a verb may be computed in another process.
    """

    # Name of the capability that the interface stands for, as mission files write it. Interfaces
    # set it; a plugin has it from its interface.
    capability: ClassVar[str] = ""

    # Whether a mission may select several plugins of the capability, which then run side by side.
    is_plural: ClassVar[bool] = False

    Settings: ClassVar[type[Settings]] = NoSettings

    # Verbs that take long, and the time that a simulated mission charges for one call [s].
    latency_s: ClassVar[Mapping[str, float]] = {}

    # Verbs that may compute for longer than a mission's rule allows, which is a multiple of their
    # latency, and their limit [s] of computing time. What takes longer has failed and is ended.
    limit_s: ClassVar[Mapping[str, float]] = {}

    # Whether a copy in a worker process, made from the same settings, gives the same answers. Verbs
    # of a plugin that says so may run beside the tick, and are tried again when their worker
    # process has died; the others are computed within the tick, once.
    is_stateless: ClassVar[bool] = False

    # Verbs of a plugin with state that take more than a share of a tick. On the wall clock a thread
    # of the plugin's own computes them, in the order in which they were called, while the tick goes
    # on calling the other verbs: the plugin guards what both use, and lets the tick wait for no
    # longer than its own short verbs take. In lock-step they are computed within the tick. Of the
    # verbs that streams call, `add_scan_pair` may be among them, and so may `keep`.
    beside_tick: ClassVar[tuple[str, ...]] = ()

    # Whether its long verbs wait for another process that computes them. On the wall clock they are
    # then awaited in a thread beside the tick.
    is_remote: bool = False

    # Modules that the plugin imports only when it starts, because they take long. What worker
    # processes are forked from imports them first, so that a worker is soon replaced.
    late_imports: ClassVar[tuple[str, ...]] = ()

    # Types of observations that the plugin takes besides those that its interface has verbs for;
    # each is handed to `take` in order of its stamp.
    takes: ClassVar[tuple[type, ...]] = ()

    def take(self, observation: object) -> None:
        """Take one observation of a type that `takes` names; by default, do nothing."""

    # How often what `keep` returns has changed so far, asked at each tick; 0 in a plugin that keeps
    # nothing.
    revision: int = 0

    def keep(self) -> Mapping[str, object]:
        """Return what the plugin has learnt and a restarted one could not measure anew.

        It is written into the run's folder as the mission goes, and `restore` is given it when a
        run that was cut off is resumed. Values are numbers, texts, arrays, messages, and lists and
        mappings of them; by default there is nothing to keep.
        """
        return {}

    def restore(self, kept: Mapping[str, object]) -> None:
        """Take back what `keep` returned in a run that was cut off; called once, after `start`."""

    def start(self) -> None:
        """Acquire resources; called once, before the first verb."""

    def close(self) -> None:
        """Release resources; also after an error, after a `start` that failed, or a second time."""

    def paused(self, now_s: float) -> None:
        """Learn that mission time stands still from now on [s]; by default, do nothing.

        The operator has paused the mission, or is asked. The robot was told to stop before, and
        observations go on: their stamps are machine time, which does not stand still.
        """

    def resumed(self, now_s: float) -> None:
        """Learn that mission time goes on [s]; the robot goes on along its path after this."""
