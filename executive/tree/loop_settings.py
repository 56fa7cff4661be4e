"""Settings of the tick loop."""

from typing import Literal

from pydantic import Field, field_validator

from executive import registry
from executive.config import Seconds, Settings
from executive.tree.job_settings import JobSettings


class LoopSettings(Settings):
    """Settings of the tick loop."""

    tick: Seconds = Field(0.05, ge=0.001, le=1.0, description="Period of the loop [s].")
    time_limit: Seconds = Field(
        7200.0, gt=0, description="The mission fails when it has taken this long [s]."
    )
    runner: Literal["inline", "thread", "process"] | None = Field(
        None,
        description="Where long verbs are computed; not given, inline in lock-step, and in worker "
        "processes on the wall clock, where inline is refused.",
    )
    late_ticks: int | None = Field(
        None,
        ge=1,
        description="On the wall clock, so many late ticks in a row bring the machine to a safe "
        "stop; not given, as many as fit into the machine's longest stop.",
    )
    heartbeat_limit: Seconds = Field(
        0.2,
        gt=0,
        description="In real time, a supervisor stops the machine when the loop is silent for so "
        "long, or the newest joint sample is so old [s].",
    )
    structure_judge: str = Field(
        "rigid_stones",
        description="Who judges in a simulated run, after its end and by the true poses, what was "
        "built of stones; none for no verdict.",
    )
    jobs: JobSettings = Field(JobSettings(), description="Limits of the long verbs.")

    @field_validator("structure_judge")
    @classmethod
    def _is_installed(cls, name: str) -> str:
        judges = (*registry.names(registry.JUDGES), registry.NO_JUDGE)
        if name not in judges:
            raise ValueError(f"no judge '{name}' is installed; there is: {', '.join(judges)}")
        return name
