"""Calls of faulty plugins in every capability and runner, and what comes of each."""

import json
import multiprocessing as mp
import os
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bounds import Bound, Figure, held

from executive import registry
from executive.clock import WallClock
from executive.mission.fault import fault_of
from executive.mission.jobs.jobs import Jobs
from executive.mission.jobs.limits import Limits
from executive.mission.jobs.process_runner import ProcessRunner
from executive.mission.jobs.runner import InlineRunner
from executive.mission.jobs.thread_runner import ThreadRunner
from executive.supervision.beacon import beacon
from executive.supervision.supervisor import supervised
from executive.tree.selection import Selection

FAULTY = Path(__file__).parents[2] / "mission" / "jobs" / "faulty"
LIMITS = Limits(factor=1.0, least_s=0.5, start_s=60.0, memory_bytes=300_000_000)
BACK_S = 2.0
GRACE_S = 2.0  # that the supervisor waits for the executive to end an overdue verb by itself
_FORK = mp.get_context("fork")  # imports are done; no thread runs yet
RUNNERS = ("inline", "thread", "process")
CURED = ("hang", "hold_gil", "sigkill", "segfault", "os_exit", "leak")  # by a new worker
WAITS = ("hang", "hold_gil")


def measured(faults: Sequence[str], capabilities: Sequence[str]) -> list[Figure]:
    """Let plugins fail; return how many cells came out wrong, and the longest time."""
    sys.path.insert(0, str(FAULTY))
    import package

    with tempfile.TemporaryDirectory() as folder:
        installed = str(package.install(Path(folder, "package")))
        sys.path.insert(0, installed)
        os.environ["PYTHONPATH"] = os.pathsep.join([installed, os.environ.get("PYTHONPATH", "")])
        registry.reread()
        import faulty_plugins as faulty

        cells = [
            cell for fault in faults for cell in row(faulty, Path(folder), fault, capabilities)
        ]
    bad = sum(outcome.startswith("BAD") for outcome, _ in cells)
    what = f"cells neither answered nor named within {BACK_S:g} s"
    return [
        held(what, bad, Bound(0), f"{bad} of {len(cells)}"),
        Figure(
            "time beyond the verb's limits, longest [s]", f"{max(took for _, took in cells):.2f}"
        ),
    ]


def row(
    faulty: Any, folder: Path, fault: str, capabilities: Sequence[str]
) -> list[tuple[str, float]]:
    """Print what came of one fault in each runner; return outcome and time [s] of its cells."""
    cells = []
    for runner in RUNNERS:
        for once in (False, True) if runner == "process" and fault in CURED else (False,):
            found = [cell(faulty, folder, fault, runner, one, once) for one in capabilities]
            came = Counter(outcome for outcome, _ in found)
            told = ", ".join(f"{count} {outcome}" for outcome, count in came.items())
            name = f"{fault}{', once' if once else ''}"
            slowest_s = max(took_s for _, took_s in found)
            print(f"{name:<22} {runner:<8} {slowest_s:5.2f} s   {told}", flush=True)
            cells += found
    return cells


def cell(
    faulty: Any, parent: Path, fault: str, runner: str, capability: str, once: bool
) -> tuple[str, float]:
    """Return what came of one cell, and the time beyond the verb's limits [s]."""
    with tempfile.TemporaryDirectory(dir=parent) as folder:
        run = Path(folder)
        asked = "" if fault == "unpicklable_argument" else fault
        settings = faulty.FaultySettings(fault=asked, once=str(run / "once") if once else "")
        arguments = [lambda: None] if fault == "unpicklable_argument" else []
        process = _FORK.Process(
            target=in_supervision,
            args=(faulty.PLUGINS[capability], settings, runner, capability, run, arguments),
        )
        process.start()
        process.join()
        status = process.exitcode or 0
        ended_s = time.monotonic()
        begun = run / "begun"
        took_s = ended_s - float(begun.read_text()) if begun.exists() else 0.0
        if fault in WAITS:  # twice in a worker that is replaced; the supervisor waits as well
            is_cut_off = fault == "hold_gil" and runner != "process"
            rounds = 2 if runner == "process" and not once else 1
            took_s -= rounds * LIMITS.least_s + (GRACE_S if is_cut_off else 0.0)
        report = run / "report.json"
        found = json.loads(report.read_text(encoding="utf-8")) if report.exists() else {}
    return what_came(status, found, fault, runner, once, took_s), took_s


def in_supervision(*cell: Any) -> None:
    """Do a call under a supervisor, in a process whose end unwinds nothing of this one."""
    sys.exit(supervised(lambda: call(*cell), lambda _: None))


def what_came(
    status: int, report: Mapping[str, Any], fault: str, runner: str, once: bool, took_s: float
) -> str:
    """Say what came of a cell; what is not as it must be begins with BAD."""
    if took_s > BACK_S:
        return f"BAD: {took_s:.1f} s"
    # Nothing has to be sent to another process inline or in a thread, and an answer is checked.
    is_sent = fault == "unpicklable_argument" and runner == "process"
    is_answered = once or fault == "late" or (fault == "unpicklable_argument" and not is_sent)
    if is_answered:
        return "answered" if status == 0 else f"BAD: status {status}"
    named = report.get("fault", {})
    is_named = named.get("name") == "faulty" and named.get("verb") and ".py:" in named.get("place")
    if status == 3 and is_named:
        return "status 3, named"
    return f"BAD: status {status}, {dict(named, traceback='')}"


def call(
    plugin_class: Any, settings: Any, runner: str, capability: str, run: Path, arguments: Any
) -> int:
    """Call the verb as a mission does; write a report of a fault, as a run does."""
    beacon().name(run_dir=str(run), mission="plugin_cells")
    plugin = plugin_class(settings)
    told: list[Any] = []
    runners = {
        "inline": InlineRunner,
        "thread": ThreadRunner,
        "process": lambda: ProcessRunner(
            {capability: (Selection("faulty", settings),)}, "m545", 1, LIMITS, told.append
        ),
    }
    plugins = {capability: plugin}
    jobs = Jobs(plugins, runners[runner](), WallClock(), is_lock_step=False, limits=LIMITS)
    try:
        (run / "begun").write_text(str(time.monotonic()), encoding="utf-8")
        plugin.start()
        jobs.prepare()
        (run / "begun").write_text(str(time.monotonic()), encoding="utf-8")
        jobs.start(getattr(plugin, next(iter(plugin.latency_s))), *arguments).result()
        return 0
    except Exception as error:
        fault = fault_of(error, plugins)
        named = {"name": fault.name, "verb": fault.verb, "place": fault.place, "error": fault.error}
        (run / "report.json").write_text(json.dumps({"fault": named}), encoding="utf-8")
        return 3
    finally:
        jobs.close()
