"""A busy mission on the wall clock: what its ticks, its memory and its files do over an hour."""

import gc
import multiprocessing as mp
import os
import resource
import tempfile
from pathlib import Path

import numpy as np
from bounds import Bound, Figure, held, judged

from executive.arrays import Float
from executive.clock import wall_s
from executive.mission.mission import Mission
from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.load import load_mission

MISSION = """
api: 1
mission: busy
plugins:
  robot: {plugin: kinematic, model: m545, noise: true}
  estimation: dual_graph
  mapping: voxel_map
  objects: sqlite
  motion: hermite
loop: {tick: 50 ms, late_ticks: 1000, time_limit: 1000 h}
trees:
  main:
    sequence:
      - {run: Localise, timeout: 30 s}
      - parallel:
          - loop: forever
            do:
              sequence:
                - {run: TurnCabin, with: {heading: 60 deg}}
                - {run: TurnCabin, with: {heading: -60 deg}}
          - loop: forever
            do:
              sequence:
                - for_each: {item: number, in: [1, 2, 3, 4, 5, 6]}
                  do: {set: {mark: "{number}"}}
                - wait: 50 ms
"""
TICK_MS = 50.0
P99_MS, WORST_MS = Bound(55.0), Bound(200.0)
# None is asked for. Medians of ten minutes differ by some 0.2 MB, as the free rest of a heap goes
# up and down; ten bytes a tick would be 0.6 MB in the 50 minutes.
GROWTH_MB = Bound(0.5)
FILES_MB = Bound(50.0)


class Waits:
    """What this process's main thread did: its time on a core, in the system, and waiting."""

    def __init__(self) -> None:
        self._file = os.open("/proc/thread-self/schedstat", os.O_RDONLY)
        self._cores = os.open("/proc/stat", os.O_RDONLY)
        self._last, self._stolen_ms = self._read(), self._stolen()
        self._used = resource.getrusage(resource.RUSAGE_THREAD)
        self._collects_s = self._began_s = 0.0
        gc.callbacks.append(self._collect)

    def _read(self) -> tuple[float, float]:
        on_core, waited, _ = os.pread(self._file, 100, 0).split()
        return 1e-6 * int(on_core), 1e-6 * int(waited)

    def _stolen(self) -> float:
        """Return for how long the computer's host has kept all cores to itself [ms]."""
        fields = os.pread(self._cores, 200, 0).split(b"\n", 1)[0].split()
        return 1e3 * float(fields[8]) / os.sysconf("SC_CLK_TCK")

    def _collect(self, phase: str, _info: object) -> None:
        if phase == "start":
            self._began_s = wall_s()
        else:
            self._collects_s += wall_s() - self._began_s

    def told(self) -> str:
        """Say where the time since the last call went."""
        now, last, collects_ms = self._read(), self._last, 1e3 * self._collects_s
        used, before = resource.getrusage(resource.RUSAGE_THREAD), self._used
        stolen_ms = self._stolen() - self._stolen_ms
        self._last, self._used, self._collects_s = now, used, 0.0
        self._stolen_ms += stolen_ms
        return (
            f"{now[0] - last[0]:.0f} ms on a core, {1e3 * (used.ru_stime - before.ru_stime):.0f} ms"
            f" of it in the system, {used.ru_majflt - before.ru_majflt} pages from the disk,"
            f" {now[1] - last[1]:.0f} ms waiting for a core, {collects_ms:.0f} ms in the garbage"
            f" collector; the host of a virtual machine took {stolen_ms:.0f} ms of all cores"
        )


class Minutes:
    """Notes the interval of each tick, and memory and files each minute; ends the run.

    Of a tick that is too late, it tells where its time went.
    """

    def __init__(self, minutes: int, folder: Path) -> None:
        self._minutes, self._folder = minutes, folder
        self._begun_s = self._last_s = 0.0
        self._waits: Waits | None = None
        # Filled, so that its pages are there from the start and count as no growth of memory.
        self.intervals_ms = np.full(int(minutes * 60e3 / TICK_MS * 1.1), np.nan, dtype=np.float32)
        self.count = 0
        self.memory_mb: list[float] = []
        self.files_mb: list[float] = []

    def __call__(self, mission: Mission) -> None:
        now_s = wall_s()
        if self._waits is None:
            self._waits, self._begun_s = Waits(), now_s
        elif self.count < len(self.intervals_ms):
            self.intervals_ms[self.count] = 1e3 * (now_s - self._last_s)
            told = self._waits.told()
            if self.intervals_ms[self.count] > WORST_MS.must:
                print(f"a tick of {self.intervals_ms[self.count]:.0f} ms: {told}", flush=True)
            self.count += 1
        self._last_s = now_s
        minute = int((now_s - self._begun_s) / 60.0)
        if minute > len(self.memory_mb):
            self._note(minute)
            if minute >= self._minutes:
                mission.request_stop()

    def _note(self, minute: int) -> None:
        children = [child.pid for child in mp.active_children()]
        self.memory_mb.append(sum(resident_mb(pid) for pid in (os.getpid(), *children) if pid))
        files = (one.stat().st_size for one in self._folder.rglob("*") if one.is_file())
        self.files_mb.append(sum(files) / 1e6)
        newest = self.intervals_ms[max(0, self.count - 1200) : self.count]
        print(
            f"minute {minute}: {self.memory_mb[-1]:.1f} MB in {1 + len(children)} processes, files "
            f"{self.files_mb[-1]:.1f} MB, tick intervals {np.percentile(newest, 99):.1f} ms at "
            f"99 %, {newest.max():.1f} ms at worst, load {os.getloadavg()[0]:.1f}",
            flush=True,
        )


def resident_mb(pid: int) -> float:
    """Return the memory that a process does not share with files [MB]; 0 for one that ended."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text(encoding="utf-8").splitlines()
    except OSError:
        return 0.0
    return sum(float(line.split()[1]) for line in lines if line.startswith("RssAnon")) / 1e3


def measured(minutes: int, settled: int) -> list[Figure]:
    """Run for so many minutes; return the figures, memory from a minute on."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "busy.yaml"
        path.write_text(MISSION, encoding="utf-8")
        noted = Minutes(minutes, Path(folder) / "run")
        options = Options(run_dir=Path(folder) / "run", real_time=True)
        report = Run(load_mission(str(path)), options).execute(noted).report
    ended = f"{report.outcome}: {report.reason}"
    intervals = noted.intervals_ms[: noted.count]
    p50, p99, worst = np.percentile(intervals if noted.count else [np.nan], [50, 99, 100])
    late = int((intervals > WORST_MS.must).sum())
    growth, words = _growth(np.array(noted.memory_mb[settled - 1 :]))
    return [
        judged("how it ended", ended, "stopped by the operator", report.outcome == "stopped"),
        Figure("tick interval, median [ms]", f"{p50:.1f} (n = {noted.count})"),
        held("tick interval, 99 % [ms]", p99, P99_MS, f"{p99:.1f}"),
        held("tick interval, worst [ms]", worst, WORST_MS, f"{worst:.1f} ({late} above)"),
        held(f"memory after minute {settled} [MB]", growth, GROWTH_MB, words),
        held("files [MB]", max(noted.files_mb), FILES_MB),
    ]


def _growth(memory_mb: Float) -> tuple[float, str]:
    """Return by how much the memory grew [MB], from the median of the first fifth to the last.

    The free rest of a worker's heap goes up and down by 2 MB from minute to minute, so that two
    single minutes tell of that rest, too; they are told beside the medians.
    """
    fifth = max(1, len(memory_mb) // 5)
    first, last = np.median(memory_mb[:fifth]), np.median(memory_mb[-fifth:])
    ends = f"first and last minute {memory_mb[0]:.1f} and {memory_mb[-1]:.1f}"
    return float(last - first), f"{last - first:+.2f} ({first:.1f} to {last:.1f}; {ends})"
