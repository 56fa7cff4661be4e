"""What checking a mission costs: processor time by number of nodes, and the whole command."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from time import process_time

from bounds import Bound, Figure, held

# Nodes: processor time that a check may take [ms].
TIMES_MS = {
    500: Bound(30),
    5_000: Bound(300, 250),
    20_000: Bound(1_500, 1_000),
    100_000: Bound(7_500, 5_000),
}
CHECK_S, CHECK_MB, HELP_S = Bound(1.0, 0.4), Bound(200), Bound(1.0, 0.4)
_HEAD = """api: 1
mission: wide
plugins: {robot: kinematic, estimation: gnss_imu_filter}
trees:
  main:
    sequence:
"""


def wide(nodes: int) -> str:
    """Return a mission whose `main` is a sequence of so many nodes."""
    lines = []
    for i in range(nodes):
        key = f"k{i - i % 3}"
        lines.append(
            (
                f"      - set: {{{key}: {i}}}\n",
                f"      - {{wait: 1 s, name: w{i}, optional: true}}\n",
                f'      - {{check: "{{{key}}} > 3", if: "{{{key}}} > 0"}}\n',
            )[i % 3]
        )
    return _HEAD + "".join(lines)


def trees(sizes: Sequence[int]) -> Iterator[Figure]:
    """Check trees of these sizes."""
    from executive.tree.load import load_mission

    with tempfile.TemporaryDirectory() as folder:
        for nodes in sizes:
            path = Path(folder) / f"wide_{nodes}.yaml"
            path.write_text(wide(nodes), encoding="utf-8")
            load_mission(str(path))  # what is imported once does not count
            times = max(3, 5_000 // nodes)
            took_s = shortest(lambda file=str(path): load_mission(file), times)  # type: ignore[misc]
            yield held(f"check of {nodes:,} nodes [ms]", 1e3 * took_s, TIMES_MS[nodes])


def shortest(work: Callable[[], object], times: int) -> float:
    """Return the shortest processor time of some work [s]."""
    taken = []
    for _ in range(times):
        begun_s = process_time()
        work()
        taken.append(process_time() - begun_s)
    return min(taken)


def commands() -> Iterator[Figure]:
    """Run the command line as people do, each time in a new process."""
    took_s, peak_mb = child("check", "pick_and_place")
    yield held("executive check pick_and_place [s]", took_s, CHECK_S)
    yield held("executive check pick_and_place [MB]", peak_mb, CHECK_MB)
    yield held("executive --help [s]", child("--help")[0], HELP_S)


def child(*words: str, times: int = 5) -> tuple[float, float]:
    """Return the shortest processor time [s] and the peak memory [MB] of a command.

    Modules are compiled once, before, as where the package is installed.

    Raises:
        subprocess.CalledProcessError: If the command fails.
    """
    command = [sys.executable, "-m", "executive.commands.main", *words]
    with tempfile.TemporaryDirectory() as compiled:
        environment = os.environ | {"PYTHONPYCACHEPREFIX": compiled, "PYTHONDONTWRITEBYTECODE": ""}
        found = [resources(command, environment) for _ in range(1 + times)][1:]
    return min(took_s for took_s, _ in found), max(peak for _, peak in found)


def resources(command: Sequence[str], environment: Mapping[str, str]) -> tuple[float, float]:
    """Return processor time [s] and peak memory [MB] of a process."""
    process = subprocess.Popen(
        command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, command)
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024 / 1e6
