"""What the command line adds to a mission file."""

from dataclasses import dataclass
from pathlib import Path

from executive.mission.record.run_options import KeptOptions


@dataclass(frozen=True, slots=True)
class Options:
    """How a mission is run; all of it may be left out."""

    seed: int = 1
    run_dir: Path | None = None
    record: bool = False
    record_log: Path | None = None
    real_time: bool = False
    apart: bool = False  # on the wall clock, a simulated machine lives in a process of its own
    runner: str | None = None
    answer: bool | None = None
    choices: tuple[str, ...] = ()
    attended: bool = False
    pause_on_failure: bool = False
    groot: int | None = None  # port of 127.0.0.1
    live: int | None = None  # port of 127.0.0.1

    @property
    def seen_by(self) -> tuple[str, ...]:
        """Return the options that need a viewer."""
        wanted = {"--record": self.record, "--live": self.live is not None}
        return tuple(option for option, is_given in wanted.items() if is_given)

    @property
    def kept(self) -> KeptOptions:
        """Return what a resumed run takes over."""
        return KeptOptions(
            self.seed,
            self.real_time,
            self.runner,
            self.answer,
            self.choices,
            self.attended,
            self.pause_on_failure,
            self.apart,
        )
