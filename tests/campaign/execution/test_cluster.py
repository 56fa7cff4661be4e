"""A campaign on workers in processes of their own: each run is counted once, whatever is lost."""

import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil
import pytest

import executive
from executive.campaign.execution import cluster_pool, input_sender
from executive.campaign.execution.cluster_pool import ClusterPool
from executive.campaign.execution.cluster_workers import ClusterError
from executive.campaign.execution.inputs import chunks_of
from executive.campaign.trial import Limits, Status, Trial
from executive.errors import ConfigError

LIMITS = Limits(time_s=60.0, memory_bytes=1 << 30)


def trials(count: int, **arguments: object) -> list[Trial]:
    return [
        Trial(n, "spread", arguments, seed=100 + n, levels={}, limits=LIMITS) for n in range(count)
    ]


@pytest.fixture
def pool(cluster) -> Iterator[ClusterPool]:
    made = ClusterPool(cluster.address)
    await_slots(made, 2)
    yield made
    made.close()


@pytest.fixture
def extra_worker(cluster) -> Iterator[Callable[..., subprocess.Popen[bytes]]]:
    """Return what starts a worker that ends with the test."""
    started = []

    def start(*args, **more) -> subprocess.Popen[bytes]:
        started.append(cluster.add_worker(*args, **more))
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.wait()


def await_slots(pool: ClusterPool, count: int) -> None:
    for _ in range(300):
        if pool.slots == count:
            return
        pool.wait(0.2)
    raise TimeoutError(f"{pool.slots} slots instead of {count}")


def runs_of(cluster) -> list[psutil.Process]:
    """Return the processes of runs that go on: those that have said so in their folder."""
    pids = [int(one.read_text() or 0) for one in cluster.folder.glob("*/*/*/run-*/began.txt")]
    return [psutil.Process(pid) for pid in pids if pid and psutil.pid_exists(pid)]


def test_every_run_is_counted_once_though_a_worker_is_killed(
    cluster, pool, finish, spread, extra_worker, tmp_path
) -> None:
    third = extra_worker("third", [spread])
    await_slots(pool, 3)
    left_behind: list[psutil.Process] = []

    def kill_one(ended: int) -> None:
        if ended >= 4 and third.poll() is None:
            left_behind.extend(psutil.Process(third.pid).children(recursive=True))
            third.kill()
            third.wait()

    outcomes, losses = finish(pool, trials(12, for_s=0.3), tmp_path / "runs", kill_one)
    assert sorted(outcome.number for outcome in outcomes) == list(range(12))
    assert all(outcome.answer["seed"] == 100 + outcome.number for outcome in outcomes)
    assert {loss.number for loss in losses} == {o.number for o in outcomes if o.tries == 2}
    assert len(losses) == 1
    assert "is gone" in losses[0].reason
    assert pool.slots == 2
    assert left_behind
    assert not psutil.wait_procs(left_behind, timeout=10)[1]


def test_a_worker_that_its_nanny_starts_again_is_used_again(
    cluster, pool, finish, spread, extra_worker, tmp_path
) -> None:
    nanny = extra_worker("fourth", [spread], nanny=True)
    await_slots(pool, 3)
    process = psutil.Process(nanny.pid)
    worker = next(c for c in process.children() if "spawn_main" in " ".join(c.cmdline()))
    worker.kill()
    await_slots(pool, 2)
    await_slots(pool, 3)
    outcomes, _ = finish(pool, trials(6, for_s=0.2), tmp_path / "runs")
    assert len({outcome.worker.partition("(")[2] for outcome in outcomes}) == 3
    nanny.terminate()
    nanny.wait()


def test_the_files_that_a_work_keeps_come_back(cluster, pool, finish, tmp_path) -> None:
    outcomes, _ = finish(pool, trials(2), tmp_path / "runs")
    assert all(outcome.status is Status.DONE for outcome in outcomes)
    for number in range(2):
        folder = tmp_path / "runs" / f"{number}-1"
        assert {one.name for one in folder.iterdir()} == {"began.txt", "output.txt", "answer.json"}
    assert not [
        one for name in ("first", "second") for one in cluster.folder.glob(f"{name}/*/*/run-*")
    ]


def test_inputs_arrive_once_and_are_equal(
    cluster, pool, finish, spread, extra_worker, tmp_path, monkeypatch
) -> None:
    stones = tmp_path / "stones"
    stones.mkdir()
    (stones / "a.txt").write_text("one stone")
    (stones / "b.txt").write_text("another")
    sent = []
    monkeypatch.setattr(
        input_sender, "chunks_of", lambda path: sent.append(path) or chunks_of(path)
    )
    given = trials(6, stones=str(stones), for_s=0.1)
    outcomes, _ = finish(pool, given, tmp_path / "runs")
    assert all(o.answer["stones"] == {"a.txt": "one stone", "b.txt": "another"} for o in outcomes)
    assert len({outcome.answer["at"] for outcome in outcomes}) == 2  # one copy a worker
    assert str(stones) not in {outcome.answer["at"] for outcome in outcomes}
    assert len(sent) == 2
    extra_worker("fifth", [spread])
    await_slots(pool, 3)
    outcomes, _ = finish(pool, given, tmp_path / "again")
    assert len({outcome.answer["at"] for outcome in outcomes}) == 3
    assert len(sent) == 3
    (stones / "a.txt").write_text("changed")
    with pytest.raises(ConfigError, match="has changed while the campaign was going on"):
        finish(pool, given, tmp_path / "changed")


def test_a_copy_that_was_removed_is_sent_again(cluster, pool, finish, tmp_path) -> None:
    stones = tmp_path / "stones"
    stones.mkdir()
    (stones / "a.txt").write_text("a stone")
    given = trials(2, stones=str(stones))
    outcomes, _ = finish(pool, given, tmp_path / "runs")
    for outcome in outcomes:
        shutil.rmtree(Path(outcome.answer["at"]).parent, ignore_errors=True)
    outcomes, losses = finish(pool, given, tmp_path / "again")
    assert [outcome.answer["stones"] for outcome in outcomes] == [{"a.txt": "a stone"}] * 2
    assert all(outcome.tries == 1 for outcome in outcomes)
    assert not losses


def test_an_absent_input_is_refused(pool, tmp_path) -> None:
    with pytest.raises(ConfigError, match="input 'stones' does not exist"):
        pool.begin(trials(1, stones="/nowhere")[0], tmp_path / "run", 1)


def test_a_worker_with_other_sources_is_refused_when_it_joins(
    pool, spread, extra_worker, tmp_path
) -> None:
    home = Path(executive.__file__).parent
    shutil.copytree(home, tmp_path / "executive", ignore=shutil.ignore_patterns("__pycache__"))
    with (tmp_path / "executive" / "clock.py").open("a") as file:
        file.write("\n# another version\n")
    pool.begin(trials(1, for_s=60.0)[0], tmp_path / "run", 1)
    extra_worker("changed", [tmp_path, spread])
    with pytest.raises(ClusterError, match="comparable") as refused:
        await_slots(pool, 3)
    assert "source files of executive" in str(refused.value)
    assert "worker tcp://127.0.0.1:" in str(refused.value)
    assert "Install the same packages" in str(refused.value)


def test_a_worker_without_the_package_is_refused(cluster, extra_worker, tmp_path) -> None:
    (tmp_path / "executive").mkdir()
    (tmp_path / "executive" / "__init__.py").write_text("raise ImportError('not installed')")
    extra_worker("bare", [tmp_path])
    pool = ClusterPool(cluster.address)
    try:
        with pytest.raises(ClusterError, match="not installed"):
            await_slots(pool, 3)
    finally:
        pool.close()


def test_a_worker_that_lacks_a_plugin_ends_the_campaign_and_costs_no_run(
    cluster, finish, extra_worker, tmp_path
) -> None:
    extra_worker("lacking")
    pool = ClusterPool(cluster.address)
    await_slots(pool, 3)
    ended: list[int] = []
    try:
        with pytest.raises(ClusterError, match="no work plugin 'spread'") as refused:
            finish(pool, trials(6, for_s=0.2), tmp_path / "runs", ended.append)
    finally:
        pool.close()
    assert "refuses trial" in str(refused.value)
    assert "work.spread" in str(refused.value)
    assert "--resume" in str(refused.value)


def test_closing_ends_the_runs_on_the_workers(cluster, pool, tmp_path) -> None:
    for trial in trials(2, for_s=60.0):
        pool.begin(trial, tmp_path / str(trial.number), 1)
    for _ in range(200):
        pool.wait(0.05)
        going = runs_of(cluster)
        if len(going) == 2:
            break
    assert len(going) == 2
    pool.close()
    assert not psutil.wait_procs(going, timeout=10)[1]


def test_no_scheduler_is_said_with_the_cure(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster_pool, "_CONNECT_S", 0.3)
    with pytest.raises(ClusterError, match="no scheduler answers at tcp:") as refused:
        ClusterPool("tcp://127.0.0.1:9")
    assert "dask scheduler" in str(refused.value)


# The last test, because the cluster ends with it.
def test_a_scheduler_that_is_lost_ends_the_campaign_and_its_runs(cluster, pool, tmp_path) -> None:
    for trial in trials(2, for_s=60.0):
        pool.begin(trial, tmp_path / str(trial.number), 1)
    while len(going := runs_of(cluster)) < 2:
        pool.wait(0.05)
    cluster.scheduler.kill()
    with pytest.raises(ClusterError, match="does not answer any more") as lost:
        await_slots(pool, 3)
    assert "--resume" in str(lost.value)
    assert not psutil.wait_procs(going, timeout=10)[1]
