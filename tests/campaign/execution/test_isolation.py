"""Whatever a run does to itself ends that run alone, and its outcome says what it was."""

import os
import time
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest

from executive.campaign.execution.disk_space import DiskFullError
from executive.campaign.execution.isolation import Isolation
from executive.campaign.execution.pool import Lost
from executive.campaign.trial import Outcome, Status, Trial
from executive.errors import ConfigError

pytestmark = pytest.mark.usefixtures("misbehaving")
MEBIBYTE = 1 << 20


@pytest.fixture
def isolation() -> Iterator[Isolation]:
    """A server of runs of one's own, to do to it what one likes."""
    made = Isolation()
    yield made
    made.close()


@pytest.fixture(scope="module")
def used_isolation() -> Iterator[Isolation]:
    """A server that all runs of the module share, whatever they have done to themselves."""
    made = Isolation()
    yield made
    made.close()


def ended(isolation: Isolation, trial: Trial, folder: Path) -> Outcome | Lost:
    folder.mkdir()
    running = isolation.begin(trial, folder, {})
    while (result := running.poll()) is None:
        isolation.wait(0.1)
    return result


@pytest.fixture
def end(used_isolation: Isolation, trial, tmp_path: Path):
    """Return what runs a trial with a behaviour to its end."""
    folder = tmp_path / "run"
    return lambda behaviour, **more: ended(used_isolation, trial(behaviour, **more), folder)


def is_gone(pid: int) -> bool:
    try:
        psutil.Process(pid).wait(timeout=5)
    except psutil.NoSuchProcess:
        return True
    except psutil.TimeoutExpired:
        return psutil.Process(pid).status() == psutil.STATUS_ZOMBIE
    return True


def test_a_run_leaves_its_answer_and_what_it_took(end) -> None:
    outcome = end("answer", for_s=0.05)
    assert outcome.status is Status.DONE
    assert outcome.answer == {"seed": 1, "inputs": {}, "prepared": 1}
    assert outcome.wall_s >= 0.05
    assert outcome.cpu_s > 0
    assert outcome.peak_memory_bytes > 10 * MEBIBYTE
    assert outcome.worker.rpartition(":")[2].isdecimal()


def test_numerical_libraries_have_one_thread(end, tmp_path: Path) -> None:
    end("threads")
    assert (tmp_path / "run" / "omp").read_text() == "1"


@pytest.mark.parametrize(
    ("behaviour", "status", "words"),
    [
        ("raises", Status.CRASHED, ["ValueError: the arm is too short", "misbehaving.py:"]),
        ("exits", Status.CRASHED, ["exit status 3"]),
        ("leaves", Status.CRASHED, ["SystemExit: enough"]),
        ("segfaults", Status.CRASHED, ["SIGSEGV", "segmentation fault", "in segfaults"]),
        ("aborts", Status.CRASHED, ["SIGABRT", "in aborts"]),
        ("kills_itself", Status.KILLED, ["SIGKILL"]),
    ],
)
def test_an_end_without_an_answer_has_its_reason(end, behaviour, status, words) -> None:
    outcome = end(behaviour)
    assert outcome.status is status
    assert outcome.answer == {}
    assert all(word in outcome.reason for word in words), outcome.reason


@pytest.mark.parametrize("behaviour", ["hangs", "ignores_signals"])
def test_a_run_beyond_its_time_is_ended(end, behaviour: str) -> None:
    outcome = end(behaviour, time_s=0.3)
    assert outcome.status is Status.TIMED_OUT
    assert "0.3 s" in outcome.reason
    assert outcome.wall_s < 10


@pytest.mark.parametrize("behaviour", ["eats", "lets_a_child_eat"])
def test_a_run_beyond_its_memory_is_ended(end, behaviour: str) -> None:
    outcome = end(behaviour, memory_bytes=400 * MEBIBYTE, mebibytes=500)
    assert outcome.status is Status.OUT_OF_MEMORY
    assert "400 MiB" in outcome.reason
    assert outcome.peak_memory_bytes > 400 * MEBIBYTE


def test_descendants_end_with_their_run(end, tmp_path: Path) -> None:
    outcome = end("has_children_and_hangs", time_s=1.0)
    assert outcome.status is Status.TIMED_OUT
    assert is_gone(int((tmp_path / "run" / "child").read_text()))
    assert is_gone(int((tmp_path / "run" / "apart").read_text()))


def test_a_child_that_outlives_a_finished_run_is_ended(end, tmp_path: Path) -> None:
    assert end("has_children", for_s=0.5).status is Status.DONE
    assert is_gone(int((tmp_path / "run" / "child").read_text()))
    assert is_gone(int((tmp_path / "run" / "apart").read_text()))


def test_a_detached_descendant_goes_on_as_long_as_its_run(end) -> None:
    outcome = end("leaves_a_group_to_itself")
    assert outcome.status is Status.DONE, outcome.reason


def test_refused_arguments_are_the_campaigns(end) -> None:
    with pytest.raises(ConfigError, match="Did you mean 'sampled_cnn'"):
        end("is_refused")


def test_a_full_disk_is_the_campaigns(end) -> None:
    with pytest.raises(DiskFullError, match="no space is left"):
        end("fills_the_disk")


def test_a_crash_costs_no_other_run(used_isolation, trial, tmp_path: Path) -> None:
    folders = [tmp_path / str(number) for number in range(2)]
    for folder in folders:
        folder.mkdir()
    patient = used_isolation.begin(trial(for_s=0.5), folders[0], {})
    crashing = used_isolation.begin(trial("segfaults", number=1), folders[1], {})
    results = {}
    while len(results) < 2:
        used_isolation.wait(0.1)
        results |= {r.number: r.status for r in (patient.poll(), crashing.poll()) if r is not None}
    assert results == {0: Status.DONE, 1: Status.CRASHED}


def test_a_run_is_killed_on_request(used_isolation, trial, tmp_path: Path) -> None:
    running = used_isolation.begin(trial("hangs"), tmp_path, {})
    while not (tmp_path / "output.txt").exists():
        assert running.poll() is None
        used_isolation.wait(0.05)
    running.kill()
    while (result := running.poll()) is None:
        used_isolation.wait(0.1)
    assert isinstance(result, Outcome)
    assert result.status is Status.KILLED


def test_closing_ends_what_runs(isolation, trial, tmp_path: Path) -> None:
    running = isolation.begin(trial("has_children_and_hangs"), tmp_path, {})
    while not (tmp_path / "apart").exists():
        running.poll()
        isolation.wait(0.05)
    time.sleep(0.1)
    isolation.close()
    assert is_gone(int((tmp_path / "child").read_text()))
    assert is_gone(int((tmp_path / "apart").read_text()))


def test_without_its_server_a_run_is_lost_and_the_next_has_another(
    isolation, trial, tmp_path: Path
) -> None:
    first, second = tmp_path / "first", tmp_path / "second"
    first.mkdir()
    running = isolation.begin(trial("has_children_and_hangs"), first, {})
    while not (first / "child").exists():
        running.poll()
        isolation.wait(0.05)
    child = int((first / "child").read_text())
    run = psutil.Process(child).parent()
    run.parent().kill()
    while (result := running.poll()) is None:
        isolation.wait(0.1)
    assert isinstance(result, Lost)
    assert is_gone(run.pid)
    assert is_gone(child)
    assert ended(isolation, trial(), second).status is Status.DONE


def test_a_server_that_cannot_prepare_says_why(
    isolation, trial, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MISBEHAVING_PREPARES", "badly")
    result = ended(isolation, trial(), tmp_path / "run")
    assert isinstance(result, Lost)
    assert "ended" in result.reason


def test_after_a_preparation_that_leaves_threads_a_run_imports_anew(
    isolation, trial, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MISBEHAVING_PREPARES", "with a thread")
    outcome = ended(isolation, trial("answer"), tmp_path / "run")
    assert isinstance(outcome, Outcome)
    assert outcome.status is Status.DONE
    assert outcome.answer["prepared"] == 0


def test_files_of_the_current_folder_are_not_taken_for_modules(
    isolation, trial, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "queue.py").write_text("raise RuntimeError('not the queue of Python')\n")
    monkeypatch.chdir(tmp_path)
    assert ended(isolation, trial("answer"), tmp_path / "run").status is Status.DONE


def test_the_environment_of_the_campaign_is_left_alone(end) -> None:
    before = dict(os.environ)
    end("answer")
    assert dict(os.environ) == before
