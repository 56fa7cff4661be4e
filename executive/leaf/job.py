"""A long computation that a leaf waits for without blocking the tick."""

from abc import ABC, abstractmethod
from typing import Any


class Job(ABC):
    """One call of a plugin's verb, under way.

    In a simulated mission a job is ready exactly when its declared latency has passed on the
    mission's clock, however long it really took; against the wall clock it is ready when it is
    done.
    """

    @abstractmethod
    def is_ready(self) -> bool:
        """Whether `result` may be called; asked once a tick."""

    @abstractmethod
    def result(self) -> Any:
        """Return what the verb returned, or raise what it raised."""

    @abstractmethod
    def cancel(self) -> None:
        """Give the result up; a worker process that is still at it after its deadline is
        replaced.
        """
