"""A pool over a made-up cluster: which worker gets a run, and what becomes of what arrives."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from executive.campaign.execution import cluster_pool
from executive.campaign.execution.cluster_pool import ClusterPool
from executive.campaign.execution.cluster_workers import AdmittedWorker, ClusterError
from executive.campaign.execution.disk_space import DiskFullError
from executive.campaign.execution.parcel import pack
from executive.campaign.execution.pool import Lost, RefusedError
from executive.campaign.execution.worker_run import Delivery, run_order
from executive.campaign.trial import Limits, Outcome, Status, Trial
from executive.errors import ConfigError

TRIAL = Trial(3, "made_up", {}, 42, {}, Limits(10.0, 10**9))
ONE = AdmittedWorker("tcp://one", "host:1", "host:cache", 1, ())
TWO = AdmittedWorker("tcp://two", "host:2", "host:cache", 2, ())
DONE = Outcome(3, Status.DONE, answer={"a": 1})


class Future:
    """A run that a worker was asked for; it ends when a test says so."""

    def __init__(self, key: str, asked: tuple[Any, ...], to: list[str]) -> None:
        self.key, self.asked, self.to = key, asked, to
        self.is_cancelled = False
        self.answer: Any = None

    def cancel(self) -> None:
        self.is_cancelled = True

    def add_done_callback(self, call: Any) -> None:
        self.call = call

    def result(self) -> Any:
        if isinstance(self.answer, BaseException):
            raise self.answer
        return self.answer

    def end(self, answer: Any) -> None:
        self.answer = answer
        self.call(self)


class Client:
    """Takes orders, and keeps them."""

    id = "client-7"

    def __init__(self) -> None:
        self.futures: list[Future] = []
        self.closed_after: float | None = None

    def submit(self, function: Any, order: Any, *, key: str, workers: list[str], pure: bool):
        assert function is run_order
        assert pure is False  # equal orders are runs of their own
        self.futures.append(Future(key, order, workers))
        return self.futures[-1]

    def close(self, timeout: float) -> None:
        self.closed_after = timeout


class Workers:
    """Two workers that go when a test says so."""

    refuses = False

    def __init__(self, client: Client, scheduler: str) -> None:
        self.admitted = {one.address: one for one in (ONE, TWO)}
        self.gone: set[str] = set()
        self.are_new = False
        self.looks = 0

    def look(self) -> frozenset[str]:
        if Workers.refuses:
            raise ClusterError("other versions")
        self.looks += 1
        for address in self.gone:
            self.admitted.pop(address, None)
        return frozenset(self.gone)

    def dismiss(self, address: str) -> None:
        del self.admitted[address]


class Sender:
    """Knows each input by its name."""

    def __init__(self, client: Client) -> None:
        self.sent: list[tuple[Any, ...]] = []
        self.forgotten: list[tuple[Any, ...]] = []

    def digests(self, inputs: Any) -> dict[str, str]:
        return {name: f"digest of {name}" for name in inputs}

    def send(self, *given: Any) -> None:
        self.sent.append(given)

    def forget(self, *given: Any) -> None:
        self.forgotten.append(given)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The time that the pool reads [s]; each look at it takes a hundredth of a second."""
    now = [0.0]

    def read() -> float:
        now[0] += 0.01
        return now[0]

    monkeypatch.setattr(cluster_pool, "wall_s", read)
    return now


@pytest.fixture
def pool(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, clock: list[float]) -> Any:
    client = Client()
    monkeypatch.setattr(cluster_pool, "_connected", lambda scheduler: client)
    monkeypatch.setattr(cluster_pool, "ClusterWorkers", Workers)
    monkeypatch.setattr(cluster_pool, "InputSender", Sender)
    monkeypatch.setattr(cluster_pool, "inputs_of", lambda trial: {"log": tmp_path})
    work = SimpleNamespace(keeps=["*.json"])
    monkeypatch.setattr(cluster_pool, "work_of", lambda trial: (work, None))
    monkeypatch.setattr(Workers, "refuses", False)
    return ClusterPool("tcp://scheduler", files_limit_bytes=1000)


def begun(pool: Any, folder: Path, trial: Trial = TRIAL, tries: int = 1) -> Future:
    pool.begin(trial, folder, tries)
    return pool._client.futures[-1]


def test_runs_go_to_the_worker_with_the_most_free_threads(pool: Any, tmp_path: Path) -> None:
    assert pool.slots == 3
    for n in range(3):
        begun(pool, tmp_path / "runs" / str(n), replace(TRIAL, number=n))
    told = [(one.to, one.asked.process, one.asked.trial.number) for one in pool._client.futures]
    assert told[0] == (["tcp://two"], "host:2", 0)
    assert sorted(told[1:])[0][0] == ["tcp://one"]
    assert sorted(told[1:])[1][0] == ["tcp://two"]
    keys = [one.key for one in pool._client.futures]
    assert keys == ["executive-client-7-0-0", "executive-client-7-1-1", "executive-client-7-2-2"]
    assert (tmp_path / "runs" / "2").is_dir()


def test_an_order_says_what_is_read_and_what_comes_back(pool: Any, tmp_path: Path) -> None:
    order = begun(pool, tmp_path / "run").asked
    assert (order.trial, order.inputs) == (TRIAL, {"log": "digest of log"})
    assert (order.keeps, order.limit_bytes) == (("*.json",), 1000)
    caches = {"tcp://one": "host:cache", "tcp://two": "host:cache"}
    sent = ({"log": tmp_path}, {"log": "digest of log"}, "tcp://two", caches)
    assert pool._sender.sent == [sent]


def test_without_a_limit_a_run_sends_back_64_mebibytes(pool: Any, tmp_path: Path) -> None:
    assert begun(ClusterPool("tcp://scheduler"), tmp_path / "run").asked.limit_bytes == 67_108_864


def test_an_outcome_arrives_with_its_files_and_the_number_of_tries(
    pool: Any, tmp_path: Path
) -> None:
    there = tmp_path / "there"
    there.mkdir()
    (there / "answer.json").write_text("{}")
    future = begun(pool, tmp_path / "run", tries=2)
    assert pool.wait(0.0) == []
    future.end(Delivery(DONE, files=pack(there, ["*.json"], 1000)))
    assert pool.wait(0.1) == [replace(DONE, tries=2)]
    assert (tmp_path / "run" / "answer.json").read_text() == "{}"
    assert pool._flights == {}
    future.end(Delivery(DONE))
    assert pool.wait(0.1) == []  # it was counted


def test_what_has_arrived_together_is_returned_together(pool: Any, tmp_path: Path) -> None:
    empty = pack(tmp_path, [], 1000)
    trials = [replace(TRIAL, number=n) for n in range(3)]
    futures = [begun(pool, tmp_path / str(one.number), one) for one in trials]
    for n, future in enumerate(futures):
        future.end(Delivery(replace(DONE, number=n), files=empty))
    assert [one.number for one in pool.wait(0.1)] == [0, 1, 2]


def test_files_that_did_not_arrive_whole_are_a_lost_run(pool: Any, tmp_path: Path) -> None:
    begun(pool, tmp_path / "run").end(Delivery(DONE, files=b"torn"))
    (lost,) = pool.wait(0.1)
    assert isinstance(lost, Lost)
    assert lost.number == 3
    assert lost.reason.startswith("worker tcp://two: the files of a run did not arrive whole")


@pytest.mark.parametrize(
    ("delivery", "kind", "told"),
    [
        (Delivery(refusal="no plugin 'x'"), RefusedError, "no plugin 'x'"),
        (Delivery(disk_full="/tmp"), DiskFullError, "worker tcp://two has no space left: /tmp"),
    ],
)
def test_what_ends_a_campaign_is_raised(
    pool: Any, tmp_path: Path, delivery: Delivery, kind: type[Exception], told: str
) -> None:
    begun(pool, tmp_path / "run").end(delivery)
    with pytest.raises(kind, match=told) as raised:
        pool.wait(0.1)
    assert getattr(raised.value, "number", 3) == 3
    assert pool._flights == {}


def test_a_refusal_of_a_worker_that_lacks_a_plugin_names_it_and_the_cure(
    pool: Any, tmp_path: Path
) -> None:
    pool._workers.admitted["tcp://two"] = replace(TWO, lacks=("metric.mine", "work.spread"))
    begun(pool, tmp_path / "run").end(Delivery(refusal="no such work"))
    with pytest.raises(
        ClusterError,
        match=r"worker tcp://two refuses trial 3: no such work\. It lacks what is installed here: "
        r"metric\.mine, work\.spread\. Install it there too",
    ):
        pool.wait(0.1)


def test_what_has_ended_well_is_returned_before_an_error_is_raised(
    pool: Any, tmp_path: Path
) -> None:
    good = begun(pool, tmp_path / "0", replace(TRIAL, number=0))
    bad = begun(pool, tmp_path / "1", replace(TRIAL, number=1))
    good.end(Delivery(replace(DONE, number=0), files=pack(tmp_path, [], 1000)))
    bad.end(Delivery(refusal="no such plugin"))
    assert [one.number for one in pool.wait(0.1)] == [0]
    with pytest.raises(RefusedError, match="no such plugin"):
        pool.wait(0.1)
    assert pool.wait(0.0) == []


def test_inputs_that_a_cache_has_lost_are_sent_again_three_times(pool: Any, tmp_path: Path) -> None:
    future = begun(pool, tmp_path / "run")
    for _ in range(3):
        future.end(Delivery(missing=("digest of log",)))
        assert pool.wait(0.05) == []
        assert pool._client.futures[-1] is not future
        future = pool._client.futures[-1]
        assert future.to == ["tcp://two"]
    assert pool._sender.forgotten == 3 * [(("digest of log",), "host:cache")]
    assert len(pool._sender.sent) == 4
    future.end(Delivery(missing=("digest of log",)))
    assert pool.wait(0.05) == [Lost(3, "worker tcp://two does not keep its inputs")]


def test_inputs_are_not_sent_to_a_worker_that_is_gone(pool: Any, tmp_path: Path) -> None:
    future = begun(pool, tmp_path / "run")
    del pool._workers.admitted["tcp://two"]
    future.end(Delivery(missing=("digest of log",)))
    assert pool.wait(0.1) == [Lost(3, "worker tcp://two does not keep its inputs")]
    assert len(pool._client.futures) == 1


def test_a_worker_that_lost_a_run_is_met_anew(pool: Any, tmp_path: Path) -> None:
    lost = Lost(3, "it is another process")
    begun(pool, tmp_path / "run").end(Delivery(lost))
    assert pool.wait(0.1) == [lost]
    assert list(pool._workers.admitted) == ["tcp://one"]
    assert pool.slots == 1


def test_a_run_without_a_result_is_lost_with_the_reason(pool: Any, tmp_path: Path) -> None:
    future, looks = begun(pool, tmp_path / "run"), pool._workers.looks
    future.end(KeyError("worker"))
    (lost,) = pool.wait(0.1)
    assert lost == Lost(3, "worker tcp://two gave no result: KeyError: 'worker'")
    assert future.is_cancelled
    assert pool._workers.looks == looks + 1  # that the scheduler is there


def test_the_runs_of_a_worker_that_is_gone_are_lost_and_cancelled(
    pool: Any, tmp_path: Path, clock: list[float]
) -> None:
    first = begun(pool, tmp_path / "0", replace(TRIAL, number=0))
    second = begun(pool, tmp_path / "1", replace(TRIAL, number=1))
    on_two = first if first.to == ["tcp://two"] else second
    on_one = second if on_two is first else first
    on_one.to = ["tcp://one"]
    pool._flights[on_one.key].worker = ONE
    pool._workers.gone = {"tcp://two"}
    assert pool.wait(0.02) == []  # it looks twice a second
    clock[0] += 0.5
    number = on_two.asked.trial.number
    assert pool.wait(1.0) == [Lost(number, "worker tcp://two is gone")]
    assert on_two.is_cancelled
    assert not on_one.is_cancelled
    on_two.end(Delivery(DONE))  # too late: it is begun elsewhere
    assert pool.wait(0.02) == []


def test_while_workers_introduce_themselves_it_looks_ten_times_a_second(
    pool: Any, clock: list[float]
) -> None:
    looks = pool._workers.looks
    clock[0] = pool._looked_s + 0.05
    pool._workers.are_new = True
    pool.wait(0.015)
    assert pool._workers.looks == looks
    clock[0] = pool._looked_s + 0.12
    pool._workers.are_new = False
    pool.wait(0.015)
    assert pool._workers.looks == looks
    pool._workers.are_new = True
    clock[0] = pool._looked_s + 0.12
    pool.wait(0.015)
    assert pool._workers.looks == looks + 1


def test_closing_ends_all_runs(pool: Any, tmp_path: Path) -> None:
    future = begun(pool, tmp_path / "run")
    pool.close()
    assert future.is_cancelled
    assert pool._flights == {}
    assert pool._client.closed_after == 10.0


def test_a_refused_worker_ends_the_pool_before_it_begins(
    pool: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    client = pool._client
    monkeypatch.setattr(Workers, "refuses", True)
    with pytest.raises(ClusterError, match="other versions"):
        ClusterPool("tcp://scheduler")
    assert client.closed_after == 10.0


def test_a_scheduler_that_does_not_answer_is_told_with_how_to_start_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async def refused(*_: object, **__: object) -> None:
        raise OSError("refused")

    monkeypatch.setattr(cluster_pool, "connect", refused)
    with pytest.raises(ConfigError, match=r"no scheduler answers at tcp://10\.0\.0\.1:8786 \(ref"):
        ClusterPool("tcp://10.0.0.1:8786")


def test_the_client_is_told_how_long_to_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    async def answers(address: str, timeout: float, **_: object) -> Any:
        async def close() -> None:
            asked.append("closed")

        asked.append((address, timeout))
        return SimpleNamespace(close=close)

    monkeypatch.setattr(cluster_pool, "connect", answers)
    monkeypatch.setattr(cluster_pool, "Client", lambda *given, **named: (given, named))
    (address,), named = cluster_pool._connected("tcp://10.0.0.1:8786")
    assert asked == [("tcp://10.0.0.1:8786", 10.0), "closed"]
    assert address == "tcp://10.0.0.1:8786"
    assert named == {"timeout": 10.0, "set_as_default": False, "name": "executive-campaign"}
