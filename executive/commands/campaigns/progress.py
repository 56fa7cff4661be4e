"""Progress of a campaign on standard error: a live table on a terminal, plain lines elsewhere."""

import sys
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from typing import Protocol

from rich.console import Console, Group
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from executive.campaign.execution.progress import Progress
from executive.campaign.reporting.result import Result, results_of
from executive.campaign.reporting.wording import shortened
from executive.campaign.trial import Status, Trial
from executive.clock import wall_s

_REFRESH_S = 0.25  # on the wall
_FAILURES = 6  # of the last ones
_REASON = 300  # characters; the report holds all
_BAR = 24  # columns
_RUNNING = 16  # the rest of the running ones is counted
_WAITING = "waiting for a worker"


class CampaignProgress(Protocol):
    """Shows how far a campaign is."""

    def __call__(self, progress: Progress) -> None:
        """Take note of how far it is."""

    def __enter__(self) -> "CampaignProgress": ...

    def __exit__(self, *_: object) -> None: ...


def campaign_progress(trials: Sequence[Trial], *, quiet: bool) -> CampaignProgress:
    """Return the progress that suits standard error: live, plain, or none."""
    if quiet:
        return SilentProgress()
    return LiveTable(trials) if sys.stderr.isatty() else PlainLines(trials)


class SilentProgress:
    """No progress."""

    def __call__(self, progress: Progress) -> None:
        return None

    def __enter__(self) -> "SilentProgress":
        return self

    def __exit__(self, *_: object) -> None:
        return None


class PlainLines:
    """One line a finished run."""

    def __init__(self, trials: Sequence[Trial]) -> None:
        self._trials = {trial.number: trial for trial in trials}
        self._told = 0
        self._is_waiting = False

    def __call__(self, progress: Progress) -> None:
        if progress.resumed > self._told:
            self._told = progress.resumed
            print(f"{progress.resumed} of {progress.total} runs have ended before", file=sys.stderr)
        if _is_waiting(progress) and not self._is_waiting:
            print(_WAITING, file=sys.stderr, flush=True)
        self._is_waiting = _is_waiting(progress)
        for result in _ended(self._trials, progress):
            self._told += 1
            width = len(str(progress.total))
            line = f"{self._told:{width}}/{progress.total}  {run_words(result)}"
            print(line, file=sys.stderr, flush=True)

    def __enter__(self) -> "PlainLines":
        return self

    def __exit__(self, *_: object) -> None:
        return None


class LiveTable:
    """Counts, the running runs and the last failures, redrawn a few times a second."""

    def __init__(self, trials: Sequence[Trial], console: Console | None = None) -> None:
        self._trials = {trial.number: trial for trial in trials}
        self._live = Live(console=console or Console(stderr=True), auto_refresh=False)
        self._failures: deque[Result] = deque(maxlen=_FAILURES)
        self._unsuccessful = 0  # missions of this session that ended without success
        self._drawn_s = 0.0

    def __call__(self, progress: Progress) -> None:
        for result in _ended(self._trials, progress):
            if result.has_failed:
                self._failures.append(result)
                self._unsuccessful += result.has_answer
        now_s = wall_s()
        if now_s - self._drawn_s >= _REFRESH_S or not progress.running:
            self._drawn_s = now_s
            self._live.update(self._picture(progress), refresh=True)

    def __enter__(self) -> "LiveTable":
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def _picture(self, progress: Progress) -> Group:
        answered = progress.counts.get(Status.DONE, 0)
        failed = progress.finished - answered + self._unsuccessful
        head = Text.assemble(
            (f"{progress.finished} of {progress.total} runs", "bold"),
            (f"  {failed} failed", "red" if failed else "dim"),
            f"  {_WAITING if _is_waiting(progress) else f'{len(progress.running)} running'}",
            (f"  {time_left(progress.left_s)}".rstrip(), "dim"),
        )
        top = Table.grid(padding=(0, 2))
        top.add_row(head, ProgressBar(progress.total, progress.finished, width=_BAR))
        parts: list[Text | Table] = [top]
        if progress.running:
            parts.append(self._running(progress))
        if self._failures:
            parts.append(Text("last failures", style="bold"))
            parts += [Text(f"  {run_words(one)}", style="red") for one in self._failures]
        return Group(*parts)

    def _running(self, progress: Progress) -> Table:
        table = Table(box=None, padding=(0, 2), header_style="dim")
        table.add_column("run", justify="right")
        table.add_column("seed", justify="right")
        table.add_column("levels")
        table.add_column("for", justify="right")
        oldest = sorted(progress.running, key=lambda one: -one.for_s)
        for one in oldest[:_RUNNING]:
            trial = self._trials[one.number]
            cells = (str(one.number), str(trial.seed), level_words(trial.levels))
            table.add_row(*cells, duration(one.for_s))
        if len(oldest) > _RUNNING:
            table.add_row("", "", f"and {len(oldest) - _RUNNING} more", "")
        return table


def _is_waiting(progress: Progress) -> bool:
    """Return whether there is no room for any run, such as on a cluster without workers."""
    return not progress.running and not progress.is_complete and not progress.stopped_by


def _ended(trials: Mapping[int, Trial], progress: Progress) -> Iterator[Result]:
    return results_of([trials[one.number] for one in progress.ended], progress.ended)


def run_words(result: Result) -> str:
    """Return a finished run in a line: number, seed, levels, outcome, duration, reason."""
    levels = level_words(result.trial.levels)
    outcome = result.outcome or result.status.value.replace("_", " ")
    where = f"seed {result.trial.seed}{f', {levels}' if levels else ''}"
    reason = " ".join(result.reason.split()) if result.has_failed else ""
    reason = f": {shortened(reason, _REASON)}" if reason else ""
    return f"run {result.trial.number} ({where}) {outcome} in {duration(result.wall_s)}{reason}"


def level_words(levels: Mapping[str, str]) -> str:
    """Return the levels of a run, such as `grasping.plugin=sampled_cnn stones=scans`."""
    return " ".join(f"{factor}={level}" for factor, level in levels.items())


def duration(seconds: float) -> str:
    """Return a duration as people say it: 0.4 s, 12 s, 3 min 05 s, 2 h 07 min."""
    if seconds < 10:
        return f"{seconds:.1f} s"
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02} min"


def time_left(seconds: float | None) -> str:
    """Return the time left in words; before a run has ended nothing is known of it."""
    return "" if not seconds else f"about {duration(seconds)} left"
