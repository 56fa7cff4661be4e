"""A long computation that a leaf waits for without blocking the tick."""

from abc import ABC, abstractmethod
from typing import Generic, TypeVar

Value_co = TypeVar("Value_co", covariant=True)


class Job(ABC, Generic[Value_co]):
    """One call of a plugin's verb that has begun.

    In a simulated mission a job is ready exactly when its declared latency has passed on the
    mission's clock, however long the computation took; on the wall clock it is ready when it is
    done.
    """

    @abstractmethod
    def is_ready(self) -> bool:
        """Return whether `result` may be called; asked once a tick."""

    @abstractmethod
    def result(self) -> Value_co:
        """Return what the verb returned, or raise what it raised."""

    @abstractmethod
    def cancel(self) -> None:
        """Give up the result.

        A worker process that still computes it after a deadline is killed and replaced.
        """
