"""How long a verb may compute and how much memory it may take."""

from collections.abc import Mapping
from dataclasses import dataclass

from executive.interfaces.plugin import Plugin
from executive.tree.job_settings import JobSettings


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of the computations of one mission.

    Attributes:
        factor: A verb is overdue after this many times the latency that its plugin declares.
        least_s: No verb is overdue before that time [s].
        start_s: Longest time in which a worker process has to start its plugin [s].
        memory_bytes: What the mission's process, and each worker, may add to the memory that it
            had when its plugins were started [byte].
    """

    factor: float
    least_s: float
    start_s: float
    memory_bytes: int

    @classmethod
    def of(cls, settings: JobSettings) -> "Limits":
        """Return the limits that a mission file sets."""
        return cls(
            settings.limit_factor,
            settings.least_limit,
            settings.start_limit,
            int(settings.memory),
        )

    def time_s(self, plugin: Plugin, verb: str) -> float:
        """Return how long one call of a verb may compute [s]."""
        declared: Mapping[str, float] = plugin.limit_s
        if verb in declared:
            return declared[verb]
        return max(self.least_s, self.factor * plugin.latency_s.get(verb, 0.0))


DEFAULT = Limits.of(JobSettings())
