"""What a worker answers to an order, with a run that is made up in place of a process."""

import errno
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("distributed")

from distributed.core import Status as WorkerStatus

from executive.campaign.execution import worker_run
from executive.campaign.execution.disk_space import DiskFullError
from executive.campaign.execution.parcel import unpack
from executive.campaign.execution.pool import Lost
from executive.campaign.execution.worker_run import Delivery, Order, run_order
from executive.campaign.trial import Limits, Outcome, Status, Trial
from executive.errors import ConfigError

TRIAL = Trial(7, "mission", {}, 1, {}, Limits(10.0, 10**9))
KEY = "task-1"


class Run:
    """Ends after some looks, with a file in its folder, or at once when it is killed."""

    def __init__(self, folder: Path, looks: int, outcome: Any) -> None:
        self.folder, self.looks, self.outcome = folder, looks, outcome
        self.is_killed = False

    def poll(self) -> Any:
        self.looks -= 1
        if self.looks > 0 and not self.is_killed:
            return None
        (self.folder / "report.json").write_text("{}")
        (self.folder / "other.bin").write_text("x")
        return self.outcome

    def kill(self) -> None:
        self.is_killed = True


class Isolated:
    """Takes the place of the processes of runs."""

    def __init__(self) -> None:
        self.looks, self.began, self.waited_s = 2, [], []
        self.outcome: Any = Outcome(7, Status.DONE, worker="here:1")

    def begin(self, trial: Trial, folder: Path, inputs: Any) -> Run:
        self.began.append((trial, inputs))
        self.run = Run(folder, self.looks, self.outcome)
        return self.run

    def wait(self, timeout_s: float) -> None:
        self.waited_s.append(timeout_s)


@pytest.fixture
def worker(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    made = SimpleNamespace(
        address="tcp://a:1",
        local_directory=str(tmp_path / "worker"),
        status=WorkerStatus.running,
        state=SimpleNamespace(tasks={KEY: SimpleNamespace(state="executing")}),
        get_current_task=lambda: KEY,
        isolation=Isolated(),
    )
    (tmp_path / "worker").mkdir()
    side = worker_run.WorkerSide(tmp_path / "cache")
    side.isolation = made.isolation
    made.side = side
    monkeypatch.setattr(worker_run, "get_worker", lambda: made)
    monkeypatch.setattr(worker_run, "_side_of", lambda _: side)
    return made


@pytest.fixture
def order(worker: Any) -> Callable[..., Order]:
    def made(process: str = "", inputs: Any = None, keeps: tuple[str, ...] = ("report.json",)):
        return Order(process or worker.side.process, TRIAL, inputs or {}, keeps, 10_000)

    return made


def test_the_outcome_names_the_worker_and_brings_what_is_kept(worker, order, tmp_path) -> None:
    told = run_order(order())
    assert told.outcome == Outcome(7, Status.DONE, worker="here:1 (tcp://a:1)")
    assert (told.missing, told.refusal, told.disk_full) == ((), "", "")
    unpack(told.files, tmp_path / "kept", 10_000)
    assert [path.name for path in (tmp_path / "kept").iterdir()] == ["report.json"]
    assert worker.isolation.began == [(TRIAL, {})]
    assert not worker.isolation.run.is_killed
    assert worker.isolation.waited_s == [worker_run._POLL_EVERY_S]
    assert list(Path(worker.local_directory).iterdir()) == []  # the folder is removed


def test_a_lost_run_names_the_worker(worker, order) -> None:
    worker.isolation.outcome = Lost(7, "its server ended")
    assert run_order(order()).outcome == Lost(7, "its server ended on worker tcp://a:1")


def test_another_process_begins_nothing(worker, order) -> None:
    told = run_order(order(process="a:2:3.0"))
    assert told == Delivery(Lost(7, "worker tcp://a:1 was started again"))
    assert not worker.isolation.began


def test_inputs_that_are_not_here_are_told(worker, order) -> None:
    told = run_order(order(inputs={"machine": "abc", "site": "abc"}))
    assert told == Delivery(missing=("abc",))
    assert not worker.isolation.began


def test_inputs_are_given_by_their_names(worker, order, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(worker.side.inputs, "find", lambda digest: tmp_path / digest)
    run_order(order(inputs={"machine": "abc", "site": "def"}))
    assert worker.isolation.began == [
        (TRIAL, {"machine": tmp_path / "abc", "site": tmp_path / "def"})
    ]


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (ConfigError("no such plugin"), Delivery(refusal="no such plugin")),
        (DiskFullError("no space is left"), Delivery(disk_full="no space is left")),
        (OSError(errno.ENOSPC, "full"), Delivery(disk_full=f"[Errno {errno.ENOSPC}] full")),
        (OSError(errno.EDQUOT, "quota"), Delivery(disk_full=f"[Errno {errno.EDQUOT}] quota")),
    ],
)
def test_what_ends_a_campaign_is_told(worker, order, monkeypatch, error, told) -> None:
    def fails(*_: Any) -> None:
        raise error

    monkeypatch.setattr(worker.isolation, "begin", fails)
    assert run_order(order()) == told
    assert list(Path(worker.local_directory).iterdir()) == []


def test_another_error_of_the_system_is_raised(worker, order, monkeypatch) -> None:
    def fails(*_: Any) -> None:
        raise OSError(errno.EACCES, "denied")

    monkeypatch.setattr(worker.isolation, "begin", fails)
    with pytest.raises(OSError, match="denied"):
        run_order(order())
    assert list(Path(worker.local_directory).iterdir()) == []


@pytest.mark.parametrize(
    ("tasks", "status", "is_killed"),
    [
        ({KEY: SimpleNamespace(state="executing")}, WorkerStatus.running, False),
        ({KEY: SimpleNamespace(state="executing")}, WorkerStatus.paused, False),
        ({KEY: SimpleNamespace(state="executing")}, WorkerStatus.closing, True),
        ({KEY: SimpleNamespace(state="cancelled")}, WorkerStatus.running, True),
        ({}, WorkerStatus.running, True),
    ],
)
def test_a_run_that_nobody_waits_for_is_killed(worker, order, tasks, status, is_killed) -> None:
    worker.isolation.looks = 4
    worker.state.tasks, worker.status = tasks, status
    run_order(order())
    assert worker.isolation.run.is_killed is is_killed
    assert len(worker.isolation.waited_s) == (1 if is_killed else 3)
