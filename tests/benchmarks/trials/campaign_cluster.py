"""Campaigns over one and two workers, and the parts of which the cost of a run consists."""

import importlib.util
import os
import pickle
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any

import psutil
from bounds import Bound, Figure, held

from executive import registry
from executive.campaign.description.campaign import Campaign
from executive.campaign.engine import Plan, run_campaign
from executive.campaign.execution.cluster_pool import FILES_LIMIT_BYTES, ClusterPool
from executive.campaign.execution.ledger import Ledger, Session
from executive.campaign.execution.parcel import pack
from executive.campaign.execution.worker_run import Delivery, Order
from executive.campaign.trial import Limits, Outcome, Status, Trial

RUN_S = 0.5
EMPTY_RUNS = 200
BLOCKS = 2  # of one and of two workers in turn, so that a change of the load meets both
INPUT_BYTES = 128 << 20


@dataclass(frozen=True)
class Timed:
    """A campaign that has ended: its duration, and processor time of its parts [s]."""

    wall_s: float
    scheduler_s: float
    campaign_s: float


class Bench:
    """Clusters with one and with two workers, in a folder of their own."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._count = 0
        local = _local_clusters()
        spread = local.install_spread(folder / "installed")
        sys.path.insert(0, str(spread))
        registry.reread()
        self.clusters = {}
        for workers in (1, 2):
            (folder / str(workers)).mkdir()
            self.clusters[workers] = local.Cluster(folder / str(workers))
            for number in range(workers):
                self.clusters[workers].add_worker(str(number), [spread])

    def timed(self, workers: int, runs: int, **arguments: Any) -> Timed:
        """Run a campaign from its first claim to its last result."""
        self._count += 1
        cluster = self.clusters[workers]
        scheduler = psutil.Process(cluster.scheduler.pid)
        with self.pool(workers) as pool:
            before = sum(scheduler.cpu_times()[:2]), time.process_time(), time.perf_counter()
            plan = Plan(self._folder / f"campaign{self._count}")
            end = run_campaign(_campaign(runs, arguments), plan, pool, lambda _: None)
            after = sum(scheduler.cpu_times()[:2]), time.process_time(), time.perf_counter()
        if end.counts[Status.DONE] != runs:
            raise RuntimeError(f"{end.counts} of {runs} runs ended")
        took = [one - other for one, other in zip(after, before, strict=True)]
        return Timed(took[2], took[0], took[1])

    @contextmanager
    def pool(self, workers: int) -> Iterator[ClusterPool]:
        """Connect, and wait until all workers are there."""
        pool = ClusterPool(self.clusters[workers].address)
        try:
            until = time.monotonic() + 60
            while pool.slots < workers:
                pool.wait(0.1)
                if time.monotonic() > until:
                    raise TimeoutError(f"{pool.slots} of {workers} workers")
            yield pool
        finally:
            pool.close()

    def stop(self) -> None:
        for cluster in self.clusters.values():
            cluster.stop()


def measured(runs: int) -> list[Figure]:
    """Return all figures; the parts take a minute and a half together."""
    with TemporaryDirectory() as name:
        bench = Bench(Path(name))
        try:
            for workers in (1, 2):  # imports, and the processes that runs are forked from
                bench.timed(workers, 2 * workers)
            print(f"load of the last minute: {os.getloadavg()[0]:.2f}", flush=True)
            figures = [*_speed(bench, runs), *_costs(bench), _inputs(bench, Path(name))]
            print(f"load of the last minute: {os.getloadavg()[0]:.2f}", flush=True)
            return [*figures, *_messages(Path(name)), _ledger(Path(name) / "ledger.sqlite")]
        finally:
            bench.stop()


def _speed(bench: Bench, runs: int) -> Iterator[Figure]:
    waiting = bench.timed(1, runs, for_s=RUN_S)
    yield held(
        "overhead of a run over the cluster, beside its own time [s]",
        waiting.wall_s / runs - RUN_S,
        Bound(0.3, 0.1),
    )
    walls: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(BLOCKS):
        for workers in (1, 2):
            walls[workers].append(bench.timed(workers, runs, computes_s=RUN_S).wall_s)
    yield held(
        f"two workers against one, {BLOCKS * runs} runs of {RUN_S} s each [times as fast]",
        sum(walls[1]) / sum(walls[2]),
        Bound(1.8, 1.95, is_least=True),
    )


def _costs(bench: Bench) -> Iterator[Figure]:
    empty = bench.timed(2, EMPTY_RUNS)
    yield held(
        "processor time of the scheduler for a run [ms]",
        1e3 * empty.scheduler_s / EMPTY_RUNS,
        Bound(15, 8),
    )
    yield held(
        "processor time of the campaign for a run, ledger included [ms]",
        1e3 * empty.campaign_s / EMPTY_RUNS,
        Bound(25, 12),
    )


def _inputs(bench: Bench, folder: Path) -> Figure:
    """Time an input from this process to the verified copies of two workers."""
    stones = folder / "stones"
    stones.mkdir()
    (stones / "a.txt").write_text("x" * INPUT_BYTES)
    trials = _campaign(2, {"stones": str(stones)}).trials
    with bench.pool(2) as pool:
        begun_s = time.perf_counter()
        for trial in trials:  # beginning a run sends first what its worker lacks
            pool.begin(trial, folder / f"input{trial.number}", 1)
        speed = 2 * INPUT_BYTES / 1e6 / (time.perf_counter() - begun_s)
    return held("inputs over the scheduler to two workers [MB/s]", speed, Bound(50, is_least=True))


def _messages(folder: Path) -> Iterator[Figure]:
    (trial,) = _campaign(1, {}).trials
    order = Order("host:1:1.0", trial, {}, ("*.txt",), FILES_LIMIT_BYTES)
    yield held("size of an order [byte]", len(pickle.dumps(order)), Bound(2000))
    run = folder / "campaign1" / "runs" / "0-1"
    files = pack(run, ["*"], FILES_LIMIT_BYTES)
    outcome = Outcome(0, Status.DONE, answer={"seed": 0}, worker="host:1")
    size = len(pickle.dumps(Delivery(outcome, files=files)))
    yield held("size of what comes back of a run without files [byte]", size, Bound(4000))


def _ledger(path: Path) -> Figure:
    """Time claims and results, each a transaction on the disk."""
    campaign = _campaign(EMPTY_RUNS, {})
    ledger = Ledger(path)
    ledger.begin(campaign.trials, campaign.digest)
    ledger.add_session(Session("", "", "", "", ""))
    answer = {"values": list(range(2000))}
    begun_s = time.perf_counter()
    for trial in campaign.trials:
        ledger.claim(trial.number)
        ledger.finish(Outcome(trial.number, Status.DONE, answer=answer))
    speed = EMPTY_RUNS / (time.perf_counter() - begun_s)
    ledger.close()
    return held("runs that the ledger claims and finishes [1/s]", speed, Bound(50, is_least=True))


def _campaign(runs: int, arguments: dict[str, Any]) -> Campaign:
    trial = Trial(0, "spread", arguments, 0, {}, Limits(60.0, 1 << 30))
    return Campaign(
        name="benchmark",
        description="",
        trials=tuple(replace(trial, number=number, seed=number) for number in range(runs)),
        factors={},
        metrics=(),
        bounds=(),
        comparisons=(),
        digest="",
        command="",
    )


def _local_clusters() -> ModuleType:
    path = Path(__file__).parents[2] / "campaign" / "cluster.py"
    spec = importlib.util.spec_from_file_location("local_clusters", path)
    if spec is None or spec.loader is None:
        raise ImportError(f"{path} cannot be loaded")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
