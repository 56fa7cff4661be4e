"""A cluster of real processes on this computer, for tests and benchmarks of campaigns."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

DEADLINE_S = 60.0  # processes start in two seconds; a busy computer needs more
# As docs/how-to/clusters.md advises: no statistics of threads a hundred times a second.
SETTINGS = {
    "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False",
    "DASK_DISTRIBUTED__ADMIN__TICK__INTERVAL": "500ms",
}


class Cluster:
    """A scheduler and workers, each a process that is bound to this computer alone."""

    def __init__(self, folder: Path) -> None:
        """Start the scheduler; all files are in a folder."""
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
        """Kill all processes."""
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
                env={**os.environ, **SETTINGS, "PYTHONPATH": path},
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


def install_spread(folder: Path) -> Path:
    """Install the work `spread` in a folder for those who look there for packages."""
    info = folder / "spread.egg-info"
    info.mkdir(parents=True)
    source = Path(__file__).with_name("spread.py")
    (folder / "spread.py").write_text(source.read_text())
    (info / "PKG-INFO").write_text("Metadata-Version: 2.1\nName: spread\nVersion: 0.1\n")
    (info / "entry_points.txt").write_text("[executive.work.v1]\nspread = spread:Spread\n")
    return folder
