"""Workers of a made-up cluster: who is admitted, who is refused and why, and who is gone."""

from dataclasses import asdict, replace
from typing import Any

import pytest
from distributed.comm import CommClosedError

from executive.campaign.execution import cluster_workers
from executive.campaign.execution.cluster_workers import (
    AdmittedWorker,
    ClusterError,
    ClusterWorkers,
    has_left,
)
from executive.campaign.execution.fingerprint import Fingerprint
from executive.campaign.execution.worker_run import introduce

HERE = Fingerprint("1.0", "abc", "3.11", {"numpy": "2.0"}, ("metric.success", "work.mission"))


def introduced(there: Fingerprint = HERE) -> dict[str, Any]:
    return {"process": "host:1", "cache": "host:cache", "fingerprint": asdict(there)}


class Client:
    """A scheduler with workers that answer what a test says."""

    def __init__(self, **answers: Any) -> None:
        self.status = "running"
        self.answers = answers
        self.threads = dict.fromkeys(answers, 2)
        self.asked: list[str] = []

    def nthreads(self) -> dict[str, int]:
        return self.threads

    def run(self, function: Any, workers: list[str], on_error: str, callback_timeout: float) -> Any:
        assert (function, on_error, callback_timeout) == (introduce, "return", 60.0)
        (address,) = workers
        self.asked.append(address)
        answer = self.answers[address]
        if isinstance(answer, SystemError):
            raise answer
        return {address: answer}


@pytest.fixture(autouse=True)
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ask workers at once, and compare with a fingerprint that is known."""

    class Thread:
        def __init__(self, target: Any, args: tuple[str], daemon: bool) -> None:
            assert daemon  # a worker that hangs does not keep the campaign from its end
            self.start = lambda: target(*args)

    monkeypatch.setattr(cluster_workers, "Thread", Thread)
    monkeypatch.setattr(cluster_workers, "local_fingerprint", lambda: HERE)


def test_an_equal_worker_is_admitted_once_with_its_threads() -> None:
    client = Client(one=introduced())
    workers = ClusterWorkers(client, "tcp://s")
    assert not workers.are_new
    assert workers.look() == frozenset()
    assert workers.admitted == {"one": AdmittedWorker("one", "host:1", "host:cache", 2, ())}
    assert not workers.are_new
    workers.look()
    assert client.asked == ["one"]


def test_a_worker_that_does_not_answer_yet_is_new_and_not_asked_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Slow:
        def __init__(self, **_: Any) -> None:
            self.start = lambda: None

    monkeypatch.setattr(cluster_workers, "Thread", Slow)
    workers = ClusterWorkers(Client(one=introduced()), "tcp://s")
    workers.look()
    assert workers.are_new
    assert workers.admitted == {}
    workers._answers.put(("one", introduced()))
    workers.look()
    assert not workers.are_new
    assert list(workers.admitted) == ["one"]


def test_a_plugin_that_a_worker_lacks_is_noted_and_refuses_nobody() -> None:
    client = Client(one=introduced(replace(HERE, plugins=("work.mission",))))
    workers = ClusterWorkers(client, "tcp://s")
    workers.look()
    assert workers.admitted["one"].lacks == ("metric.success",)


def test_who_is_gone_is_told_once_and_met_anew() -> None:
    client = Client(one=introduced(), two=introduced())
    workers = ClusterWorkers(client, "tcp://s")
    workers.look()
    del client.threads["one"]
    assert workers.look() == {"one"}
    assert list(workers.admitted) == ["two"]
    assert workers.look() == frozenset()
    client.threads["one"] = 3
    workers.look()
    assert workers.admitted["one"].threads == 3


def test_a_dismissed_worker_is_asked_again() -> None:
    client = Client(one=introduced())
    workers = ClusterWorkers(client, "tcp://s")
    workers.look()
    workers.dismiss("one")
    workers.dismiss("stranger")
    assert workers.admitted == {}
    workers.look()
    assert client.asked == ["one", "one"]
    assert list(workers.admitted) == ["one"]


@pytest.mark.parametrize(
    ("answer", "told"),
    [
        (introduced(replace(HERE, version="0.9")), "worker bad: .*0.9"),
        (ValueError("x"), "worker bad: it did not answer as this .* does .ValueError: x"),
        (SystemError("torn"), "worker bad: it did not answer as this .* .SystemError: torn"),
        ({"process": "p"}, "worker bad: its version of executive states other things"),
        ({"fingerprint": {"age": 3}}, "worker bad: its version of executive states other"),
    ],
)
def test_another_installation_is_refused_with_its_address_and_the_cure(
    answer: Any, told: str
) -> None:
    workers = ClusterWorkers(Client(good=introduced(), bad=answer), "tcp://s")
    with pytest.raises(ClusterError, match=told) as refused:
        workers.look()
    assert "results of 1 of 2 workers would not be comparable" in str(refused.value)
    assert "Install the same packages there as here" in str(refused.value)
    assert list(workers.admitted) == ["good"]


@pytest.mark.parametrize(
    "answer", [CommClosedError(), ConnectionError(), TimeoutError(), OSError("timed out")]
)
def test_a_worker_that_left_is_no_refusal_and_is_asked_again(answer: Exception) -> None:
    client = Client(one=answer)
    workers = ClusterWorkers(client, "tcp://s")
    workers.look()
    assert workers.admitted == {}
    client.answers["one"] = introduced()
    workers.look()
    assert list(workers.admitted) == ["one"]


def test_an_answer_of_a_worker_that_has_gone_meanwhile_is_dropped() -> None:
    client = Client(one=introduced())
    workers = ClusterWorkers(client, "tcp://s")
    workers._answers.put(("elsewhere", ValueError("broken")))
    workers.look()
    assert list(workers.admitted) == ["one"]


def test_an_error_of_the_system_is_an_answer() -> None:
    assert not has_left(OSError(28, "no space"))
    assert not has_left(ValueError())
    assert not has_left(FileNotFoundError("x"))


def test_a_scheduler_that_is_gone_is_an_error_with_the_cure() -> None:
    client = Client(one=introduced())
    client.status = "closed"
    with pytest.raises(
        ClusterError, match=r"the scheduler tcp://s does not answer any more \(the connection is cl"
    ):
        ClusterWorkers(client, "tcp://s").look()
