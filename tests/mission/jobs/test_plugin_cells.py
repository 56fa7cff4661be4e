"""Whatever a plugin does, its call comes to an answer or to an error that names it.

The cells of a table: each fault, each capability with jobs, each runner. Faults that end the
process that computes are for worker processes here; `tests/commands/test_guard.py` has them in the
mission's own process.
"""

import re
import time
from dataclasses import replace

import pytest

from executive.clock import SimulatedClock, WallClock
from executive.errors import ExecutiveError
from executive.mission.fault import fault_of
from executive.mission.jobs.jobs import Jobs
from executive.mission.jobs.limits import Limits
from executive.mission.jobs.process_runner import ProcessRunner
from executive.mission.jobs.runner import InlineRunner
from executive.mission.jobs.thread_runner import ThreadRunner
from executive.tree.selection import Selection

LIMITS = Limits(factor=1.0, least_s=0.4, start_s=60.0, memory_bytes=300_000_000)
# Faults that end by themselves have time on a busy computer; only these end by the limit.
PATIENT = replace(LIMITS, least_s=60.0)
ENDLESS = ("hang", "hold_gil", "sigstop")
CAPABILITIES = (
    "segmentation",
    "surveying",
    "alignment",
    "registration",
    "motion",
    "grasping",
    "placing",
)
DEADLY = ("sigkill", "segfault", "os_exit")
BACK_S = 2.0


class Cell:
    """One plugin with one fault, and jobs that compute its verb."""

    def __init__(self, faulty, capability, runner, fault, once=""):
        self.plugin_class = faulty.PLUGINS[capability]
        settings = faulty.FaultySettings(fault=fault, once=str(once))
        plugin = self.plugin_class(settings)
        self.verb = getattr(plugin, next(iter(plugin.latency_s)))
        self.told = []
        limits = LIMITS if fault in ENDLESS else PATIENT
        selections = {capability: (Selection("faulty", settings),)}
        made = {
            "inline": InlineRunner,
            "thread": ThreadRunner,
            "process": lambda: ProcessRunner(selections, "m545", 1, limits, self.told.append),
        }[runner]()
        self.plugins = {capability: plugin}
        self.jobs = Jobs(self.plugins, made, WallClock(), is_lock_step=False, limits=limits)

    def __enter__(self):
        self.jobs.prepare()
        return self

    def __exit__(self, *_):
        self.jobs.close()

    def fault(self, *arguments):
        """Return the fault that a call ends in."""
        with pytest.raises((ExecutiveError, ValueError, MemoryError)) as error:
            self.jobs.start(self.verb, *arguments).result()
        return fault_of(error.value, self.plugins)


def line_of(faulty, fault):
    """Return where the fault is written; of those that leave no trace, nothing."""
    with open(faulty.__file__, encoding="utf-8") as file:
        lines = file.read().splitlines()
    found = [i for i, line in enumerate(lines, 1) if line.endswith(f"# the line of: {fault}")]
    return found[0] if found else None


def assert_named(faulty, fault, cell, name):
    """Plugin, verb, file and line are named; the line is that of the fault where it can be."""
    assert fault.name == "faulty"
    assert fault.verb
    assert re.search(r"faulty_plugins\.py:\d+$", fault.place), fault.place
    line = line_of(faulty, name)
    if line is not None:
        assert fault.place.endswith(f":{line}")


@pytest.mark.parametrize("runner", ["inline", "thread", "process"])
@pytest.mark.parametrize("name", ["raise", "wrong_type", "nan", "hang", "sys_exit", "leak"])
def test_every_runner_names_what_failed(faulty, runner, name):
    with Cell(faulty, "motion", runner, name) as cell:
        assert_named(faulty, cell.fault(), cell, name)


@pytest.mark.parametrize("runner", ["inline", "thread", "process"])
def test_an_answer_that_is_late_but_within_its_limit_is_an_answer(faulty, runner):
    with Cell(faulty, "motion", runner, "late") as cell:
        assert cell.jobs.start(cell.verb).result() is not None


@pytest.mark.parametrize("name", [*DEADLY, "unpicklable_answer", "hold_gil"])
def test_a_worker_that_always_fails_ends_in_a_fault(faulty, name):
    with Cell(faulty, "motion", "process", name) as cell:
        fault = cell.fault()
        assert_named(faulty, fault, cell, name)
        expected = {"sigkill": "SIGKILL", "segfault": "SIGSEGV", "os_exit": "exit status 0"}
        assert expected.get(name, "") in fault.error


@pytest.mark.parametrize("capability", CAPABILITIES)
def test_a_worker_that_dies_is_replaced_and_its_verb_tried_again(faulty, capability, tmp_path):
    with Cell(faulty, capability, "process", "sigkill", tmp_path / "once") as cell:
        begun = time.monotonic()
        cell.jobs.start(cell.verb).result()
        assert time.monotonic() - begun < BACK_S
        assert [(one.capability, one.name) for one in cell.told] == [(capability, "faulty")]
        assert "SIGKILL" in cell.told[0].reason


@pytest.mark.parametrize("name", ["segfault", "os_exit", "hang", "hold_gil", "leak"])
def test_what_a_new_worker_cures_is_tried_once_more(faulty, name, tmp_path):
    with Cell(faulty, "segmentation", "process", name, tmp_path / "once") as cell:
        cell.jobs.start(cell.verb).result()
        assert len(cell.told) == 1


def test_an_argument_that_cannot_be_sent_fails_its_call_and_no_other(faulty):
    with Cell(faulty, "motion", "process", "") as cell:
        fault = cell.fault(lambda: None)
        assert "an argument cannot be sent" in fault.error
        assert fault.verb == "move"
        assert cell.jobs.start(cell.verb).result() is not None


def test_a_worker_that_cannot_start_says_so(faulty):
    cell = Cell(faulty, "motion", "process", "start")
    with pytest.raises(ValueError, match="cannot start") as error:
        cell.jobs.prepare()
    cell.jobs.close()
    assert_named(faulty, fault_of(error.value, {}), None, "start")


def test_a_worker_that_the_system_does_not_start_says_so(faulty, monkeypatch):
    import multiprocessing.context as context

    def refuse(self):
        raise OSError("no more processes")

    monkeypatch.setattr(context.ForkServerProcess, "start", refuse)
    cell = Cell(faulty, "motion", "process", "")
    with pytest.raises(ExecutiveError, match="did not start: no more processes"):
        cell.jobs.prepare()
    cell.jobs.close()


def test_after_a_hang_in_a_thread_another_thread_serves(faulty, tmp_path):
    with Cell(faulty, "motion", "thread", "hang", tmp_path / "once") as cell:
        assert "no answer within 0.4 s" in cell.fault().error
        assert cell.jobs.start(cell.verb).result() is not None


def test_a_worker_that_a_signal_stopped_is_named_as_that(faulty):
    with Cell(faulty, "motion", "process", "sigstop") as cell:
        assert "was stopped by a signal (SIGSTOP or SIGTSTP)" in cell.fault().error
        assert "was stopped by a signal" in cell.told[0].reason


def test_a_plugin_may_declare_its_own_limit(faulty, monkeypatch):
    monkeypatch.setattr(faulty.FaultyMotion, "limit_s", {"move": 0.1}, raising=False)
    with Cell(faulty, "motion", "thread", "hang") as cell:
        assert "no answer within 0.1 s" in cell.fault().error


def test_in_lock_step_a_verb_that_hangs_does_not_hold_the_mission_for_ever(faulty):
    cell = Cell(faulty, "motion", "thread", "hang")
    clock = SimulatedClock()
    jobs = Jobs(cell.plugins, ThreadRunner(), clock, is_lock_step=True, limits=LIMITS)
    job = jobs.start(cell.verb)
    while not job.is_ready():
        clock.advance(0.05)
    with pytest.raises(ExecutiveError, match="no answer within"):
        job.result()
    jobs.close()
