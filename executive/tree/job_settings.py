"""Settings of the long verbs of plugins: where they are computed, and their limits."""

from pydantic import Field

from executive.config import Bytes, Seconds, Settings


class JobSettings(Settings):
    """Limits of the verbs that are computed as jobs.

    A plugin that declares `limit_s` for a verb sets the limit of time itself. Limits of verbs are
    times on the wall in real time; in lock-step they are processor times, so that a busy computer
    ends no mission, and a verb that does not compute at all is ended after that time on the wall.
    """

    limit_factor: float = Field(
        20.0,
        ge=1,
        description="A verb is overdue after this many times the latency that its plugin declares.",
    )
    least_limit: Seconds = Field(
        30.0, gt=0, description="No verb is overdue before this time of computation [s]."
    )
    start_limit: Seconds = Field(
        120.0, gt=0, description="A worker process has to have started its plugin by then [s]."
    )
    memory: Bytes = Field(
        8e9,
        gt=0,
        description="Memory that a process of the mission, and each of its workers, may add to "
        "what it has when its plugins are started [byte].",
    )
