"""A cluster of real processes on this computer, and work for it that its workers find installed."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest

from executive import registry
from executive.campaign.execution.pool import Lost, Pool
from executive.campaign.trial import Outcome, Trial

DEADLINE_S = 60.0  # processes start in two seconds; a busy computer needs more


class Cluster:
    """A scheduler and workers, each a process that is bound to this computer alone."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._file = folder / "scheduler.json"
        self._processes: list[subprocess.Popen[bytes]] = []
        self.scheduler = self._start("dask_scheduler", [], "--port", "0")
        self.address = self._address()

    def add_worker(
        self, name: str, paths: Sequence[Path] = (), nanny: bool = False
    ) -> subprocess.Popen[bytes]:
        """Start a worker with its own folder, which looks for packages in some paths first."""
        options = ["--name", name, "--nthreads", "1", "--nanny" if nanny else "--no-nanny"]
        folder = ["--local-directory", str(self.folder / name)]
        return self._start("dask_worker", paths, *options, *folder)

    def stop(self) -> None:
        for process in reversed(self._processes):
            process.kill()
        for process in self._processes:
            process.wait()

    def _start(self, command: str, paths: Sequence[Path], *options: str) -> subprocess.Popen[bytes]:
        path = os.pathsep.join([*map(str, paths), os.environ.get("PYTHONPATH", "")])
        common = ["--scheduler-file", str(self._file), "--host", "127.0.0.1", "--no-dashboard"]
        with (self.folder / f"{command}.log").open("a") as log:
            process = subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.{command}", *common, *options],
                env={**os.environ, "PYTHONPATH": path},
                cwd=self.folder,  # where Python looks before the paths
                stdout=log,
                stderr=log,
            )
        self._processes.append(process)
        return process

    def _address(self) -> str:
        until = time.monotonic() + DEADLINE_S
        while time.monotonic() < until:
            try:
                return str(json.loads(self._file.read_text())["address"])
            except (OSError, ValueError):
                time.sleep(0.05)
        raise TimeoutError("the scheduler did not start")


@pytest.fixture(scope="module")
def spread(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Install the work `spread` for this process, and return the folder for others."""
    folder = tmp_path_factory.mktemp("installed")
    info = folder / "spread.egg-info"
    info.mkdir()
    source = Path(__file__).parents[1] / "spread.py"
    (folder / "spread.py").write_text(source.read_text())
    (info / "PKG-INFO").write_text("Metadata-Version: 2.1\nName: spread\nVersion: 0.1\n")
    (info / "entry_points.txt").write_text("[executive.work.v1]\nspread = spread:Spread\n")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(folder))
        registry.reread()
        yield folder
    registry.reread()


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory, spread: Path) -> Iterator[Cluster]:
    """A scheduler with two workers."""
    made = Cluster(tmp_path_factory.mktemp("cluster"))
    try:
        for name in ("first", "second"):
            made.add_worker(name, [spread])
        yield made
    finally:
        made.stop()


@pytest.fixture
def finish() -> Callable[..., tuple[list[Outcome], list[Lost]]]:
    """Return what runs trials to their end as a campaign does: a lost one is begun again."""

    def run(
        pool: Pool,
        trials: Sequence[Trial],
        folder: Path,
        after: Callable[[int], None] = lambda ended: None,
    ) -> tuple[list[Outcome], list[Lost]]:
        waiting = [(trial, 1) for trial in trials]
        going: dict[int, tuple[Trial, int]] = {}
        outcomes: list[Outcome] = []
        losses: list[Lost] = []
        until = time.monotonic() + DEADLINE_S
        while waiting or going:
            assert time.monotonic() < until, f"{len(outcomes)} ended, {going} did not"
            while waiting and len(going) < pool.slots:
                trial, tries = waiting.pop(0)
                going[trial.number] = (trial, tries)
                pool.begin(trial, folder / f"{trial.number}-{tries}", tries)
            for end in pool.wait(0.5):
                trial, tries = going.pop(end.number)
                if isinstance(end, Lost):
                    losses.append(end)
                    waiting.append((trial, tries + 1))
                else:
                    outcomes.append(end)
                after(len(outcomes))
        return outcomes, losses

    return run
