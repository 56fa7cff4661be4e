"""A campaign from its description to its results: claim, begin, wait, finish, until all are done.

What is on the disk is always enough to go on: a trial is claimed before its run begins, and its
outcome is written once, whatever ends this process.
"""

import os
import signal
import socket
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from executive.campaign.description.campaign import Campaign
from executive.campaign.execution.disk_space import disk_errors
from executive.campaign.execution.fingerprint import local_fingerprint
from executive.campaign.execution.folder import CampaignFolder
from executive.campaign.execution.folder_lock import FolderLock
from executive.campaign.execution.ledger import Ledger, Session, TryState
from executive.campaign.execution.pool import Lost, Pool, RefusedError
from executive.campaign.execution.progress import Progress, RunningTrial
from executive.campaign.execution.run_answer import read_answer
from executive.campaign.trial import Outcome, Status, Trial
from executive.clock import wall_s
from executive.errors import ConfigError

_WAIT_S = 0.5  # for a run to end, before progress is reported again
_MOST_LOST = 3  # tries whose worker was lost, before the trial counts as failed


@dataclass(frozen=True, slots=True)
class Plan:
    """Where a campaign is run, and what of earlier results is kept.

    Attributes:
        folder: Its folder; made if it is not there.
        is_resumed: Whether results that are there are continued; else they are refused.
        again: Statuses whose outcomes are discarded, so that their trials are run again.
    """

    folder: Path
    is_resumed: bool = False
    again: tuple[Status, ...] = ()


def run_campaign(
    campaign: Campaign, plan: Plan, pool: Pool, after_change: Callable[[Progress], None]
) -> Progress:
    """Run what is pending of a campaign; the pool is closed afterwards.

    Args:
        campaign: What is run.
        plan: Where, and what of earlier results is kept.
        pool: Where runs happen.
        after_change: Called when runs begin or end, and twice a second, to show progress.

    Returns:
        How it ended: every trial has an outcome, or a person stopped it.

    Raises:
        ConfigError: If the folder holds another campaign or one that still works, or a work refuses
            its arguments. What is finished is kept.
        DiskFullError: If no space is left. What is finished is kept.
    """
    folder = CampaignFolder(plan.folder)
    with (
        closing(pool),
        disk_errors(folder.path),
        _locked(folder),
        closing(Ledger(folder.results)) as ledger,
    ):
        _begin_session(ledger, campaign, plan)
        folder.keep_description(campaign.text)
        runs = _Runs(campaign, folder, ledger, pool)
        runs.take_over()
        with _stop_requested() as stop:
            try:
                while not runs.are_over and not stop:
                    runs.begin()
                    after_change(runs.progress())
                    runs.finish(_WAIT_S)
            finally:
                runs.release()
        end = runs.progress("".join(stop))
        after_change(end)  # before another campaign may use the folder
        return end


class _Runs:
    """The runs of one session: what is pending, what goes on, what has ended."""

    def __init__(
        self, campaign: Campaign, folder: CampaignFolder, ledger: Ledger, pool: Pool
    ) -> None:
        self._trials = {trial.number: trial for trial in campaign.trials}
        self._folder = folder
        self._ledger = ledger
        self._pool = pool
        self._pending: list[int] = []  # the next one last
        self._running: dict[int, tuple[int, float]] = {}  # try and start [s], by number
        self._counts: Counter[Status] = Counter()
        self._resumed = 0
        self._durations_s: list[float] = []
        self._ended: list[Outcome] = []  # since progress was reported last

    @property
    def are_over(self) -> bool:
        return not self._pending and not self._running

    def take_over(self) -> None:
        """Adopt complete answers of a session that was killed; the rest of its claims is free."""
        for number, tries in self._ledger.claims():
            answer = read_answer(self._folder.run(number, tries), self._trials[number])
            if answer is None:
                self._ledger.release(number, TryState.RELEASED, "its campaign was killed")
            else:
                self._ledger.finish(replace(answer.outcome(number), tries=tries))
        self._counts = self._ledger.counts()
        self._resumed = self._counts.total()
        self._pending = self._ledger.pending()[::-1]

    def begin(self) -> None:
        """Begin runs as long as the pool has room."""
        while self._pending and len(self._running) < self._pool.slots:
            number = self._pending.pop()
            tries = self._ledger.claim(number)
            self._running[number] = (tries, wall_s())
            self._pool.begin(self._trials[number], self._folder.run(number, tries), tries)

    def finish(self, timeout_s: float) -> None:
        """Wait for runs to end, and write down what came of them."""
        try:
            ended = self._pool.wait(timeout_s)
        except RefusedError as error:
            ended = [self._refused(error)]
        for one in ended:
            if isinstance(one, Lost):
                self._try_again(one)
            else:
                self._finish(one)

    def release(self) -> None:
        """Give up what still runs; it counts for nothing and is pending again."""
        for number in self._running:
            self._ledger.release(number, TryState.RELEASED, "the campaign was stopped")
        self._running.clear()

    def progress(self, stopped_by: str = "") -> Progress:
        now_s = wall_s()
        running = tuple(
            RunningTrial(number, now_s - begun_s) for number, (_, begun_s) in self._running.items()
        )
        left_s = self._left_s(sum(one.for_s for one in running))
        ended, self._ended = tuple(self._ended), []
        counts, total = Counter(self._counts), len(self._trials)
        return Progress(total, counts, running, left_s, stopped_by, self._resumed, ended)

    def _left_s(self, done_s: float) -> float | None:
        """Return what is left of the work, at the mean duration so far, over the pool's room."""
        left = len(self._pending) + len(self._running)
        if not left:
            return 0.0
        if not self._durations_s or not self._pool.slots:
            return None
        mean_s = sum(self._durations_s) / len(self._durations_s)
        return max(0.0, left * mean_s - done_s) / min(left, self._pool.slots)

    def _finish(self, outcome: Outcome) -> None:
        self._ledger.finish(outcome)
        del self._running[outcome.number]
        self._counts[outcome.status] += 1
        self._durations_s.append(outcome.wall_s)
        self._ended.append(outcome)

    def _try_again(self, lost: Lost) -> None:
        tries, _ = self._running[lost.number]
        if self._ledger.lost(lost.number) + 1 < _MOST_LOST:
            self._ledger.release(lost.number, TryState.LOST, lost.reason)
            del self._running[lost.number]
            self._pending.append(lost.number)
            return
        reason = f"its worker was lost {_MOST_LOST} times; at last: {lost.reason}"
        self._finish(Outcome(lost.number, Status.CRASHED, reason=reason, tries=tries))

    def _refused(self, error: RefusedError) -> Outcome:
        """Return a refusal as the failure of one run, if others with its arguments were done.

        Raises:
            RefusedError: If there is no other: then every run would end so.
        """
        trial = self._trials[error.number]
        if not any(_are_alike(trial, self._trials[number]) for number in self._ledger.done()):
            raise error
        tries, _ = self._running[error.number]
        return Outcome(error.number, Status.CRASHED, reason=f"refused: {error}", tries=tries)


def _are_alike(one: Trial, other: Trial) -> bool:
    return one.work == other.work and one.arguments == other.arguments


def _begin_session(ledger: Ledger, campaign: Campaign, plan: Plan) -> None:
    """Write down what is asked for, or see that it is what the folder was made for."""
    if ledger.digest is None and any(CampaignFolder(plan.folder).runs.glob("*")):
        raise ConfigError(
            f"{plan.folder} holds runs, but the ledger of their results is gone; give another "
            "--out, or remove the runs. Nothing was changed"
        )
    if ledger.digest is None:
        ledger.begin(campaign.trials, campaign.digest)
    elif ledger.digest != campaign.digest:
        raise ConfigError(
            f"{plan.folder} holds another campaign: {_difference(ledger, campaign)}. Give another "
            "--out, or the campaign file as it was. Nothing was changed"
        )
    elif not plan.is_resumed:
        raise ConfigError(
            f"{plan.folder} holds results of this campaign already: --resume goes on with them, "
            "and another --out begins anew. Nothing was changed"
        )
    software = local_fingerprint()
    ledger.add_session(
        Session(
            begun=datetime.now(UTC).isoformat(timespec="seconds"),  # noqa: TID251 - for people
            owner=f"{socket.gethostname()}:{os.getpid()}",
            command=campaign.command,
            version=software.version,
            source=software.sources,
        )
    )
    for status in plan.again:
        ledger.put_back(status)


def _difference(ledger: Ledger, campaign: Campaign) -> str:
    there = list(ledger.trials())
    if len(there) != len(campaign.trials):
        return f"it has {len(there)} runs, this one has {len(campaign.trials)}"
    for old, new in zip(there, campaign.trials, strict=True):
        for field in ("work", "seed", "levels", "arguments"):
            before, now = getattr(old, field), getattr(new, field)
            if before != now:
                shown = "" if field == "arguments" else f": {before}, not {now}"
                return f"run {new.number} has other {field}{shown}"
    return "its digest is another"


@contextmanager
def _locked(folder: CampaignFolder) -> Iterator[None]:
    try:
        folder.path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ConfigError(f"{folder.path} cannot be made: {error.strerror}") from error
    lock = FolderLock(folder.lock)
    try:
        yield
    finally:
        lock.release()


@contextmanager
def _stop_requested() -> Iterator[list[str]]:
    """Give a list that holds the name of the first signal to stop, once there is one."""
    asked: list[str] = []
    if threading.current_thread() is not threading.main_thread():
        yield asked
        return

    def stop(number: int, _frame: object) -> None:
        asked[:] = asked or [signal.Signals(number).name]

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield asked
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
