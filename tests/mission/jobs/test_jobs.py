"""Long verbs give the same answers wherever they are computed, at the same time on the mission's
clock.
"""

import threading
import time
from concurrent.futures import Future
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from executive.clock import SimulatedClock, WallClock
from executive.errors import ConfigError
from executive.interfaces.plugin import Plugin
from executive.machine.machine import load_machine
from executive.mission.jobs import process_runner
from executive.mission.jobs.call import Address, VerbCall, VerbOverdueError
from executive.mission.jobs.jobs import Jobs
from executive.mission.jobs.limits import DEFAULT
from executive.mission.jobs.process_runner import ProcessRunner
from executive.mission.jobs.runner import InlineRunner, Task, noted
from executive.mission.jobs.thread_runner import ThreadRunner
from executive.mission.jobs.worker import Worker
from executive.registry import load, settings_of
from executive.supervision.beacon import beacon
from executive.tree.selection import Selection


class Calculator(Plugin):
    is_stateless = True
    latency_s = {"square": 0.3}

    def square(self, x):
        return x * x

    def fail(self):
        raise ValueError("no")


def jobs_with(runner, *, is_lock_step=True, clock=None):
    clock = clock or SimulatedClock()
    return Jobs({"motion": Calculator()}, runner, clock, is_lock_step=is_lock_step), clock


@pytest.mark.parametrize("runner", [InlineRunner, ThreadRunner])
def test_a_job_is_ready_when_its_latency_has_passed(runner):
    jobs, clock = jobs_with(runner())
    job = jobs.start(plugin_of(jobs).square, 7)
    ready_at = None
    for tick in range(10):
        if job.is_ready():
            ready_at = tick
            break
        clock.advance(0.05)
    assert ready_at == 6
    assert job.result() == 49
    jobs.close()


class Witness(Plugin):
    """Tells in which thread it was asked; its answer would depend on when, so it must not be asked
    beside the tick.
    """

    beside_tick = ("read",)

    def look(self):
        return threading.current_thread()

    def read(self):
        return threading.current_thread()


def where():
    return threading.current_thread()


RUNNERS = pytest.mark.parametrize(
    "make", [ThreadRunner, lambda: ProcessRunner({}, "m545", 1)], ids=["thread", "process"]
)


@RUNNERS
@pytest.mark.parametrize("is_lock_step", [True, False])
def test_a_plugin_with_state_is_asked_within_the_tick(make, is_lock_step):
    clock = SimulatedClock() if is_lock_step else WallClock()
    jobs = Jobs({"surveying": Witness()}, make(), clock, is_lock_step=is_lock_step)
    assert jobs.start(plugin_of(jobs).look).result() is threading.current_thread()
    jobs.close()


@RUNNERS
def test_on_the_wall_clock_a_thread_computes_what_is_named_for_it_and_leaves_functions(make):
    jobs = Jobs({"surveying": Witness()}, make(), WallClock(), is_lock_step=False)
    threads = [jobs.start(call).result() for call in (plugin_of(jobs).read, where)]
    assert len({*threads, threading.current_thread()}) == 3  # no verb waits for a function
    jobs.close()


@RUNNERS
def test_in_lock_step_they_are_computed_in_the_tick_and_ready_at_once(make):
    jobs = Jobs({"surveying": Witness()}, make(), SimulatedClock(), is_lock_step=True)
    for call in (plugin_of(jobs).read, where):
        job = jobs.start(call)
        assert job.is_ready()
        assert job.result() is threading.current_thread()
    jobs.close()


def test_a_function_of_a_leaf_that_computes_for_too_long_fails():
    over = threading.Event()
    limits = replace(DEFAULT, least_s=0.05)
    jobs = Jobs({}, ThreadRunner(), WallClock(), is_lock_step=False, limits=limits)
    job = jobs.start(endless, over)
    with pytest.raises(VerbOverdueError, match=r"'endless' of a leaf: no answer within 0\.05 s"):
        job.result()
    over.set()
    jobs.close()


def endless(over):
    over.wait(60.0)


def test_a_method_of_something_else_than_a_plugin_is_refused():
    jobs = Jobs({}, ThreadRunner(), WallClock(), is_lock_step=False)
    with pytest.raises(ConfigError, match="is no method of a plugin of this mission"):
        jobs.start(Witness().look)
    jobs.close()


@pytest.mark.parametrize("runner", [InlineRunner, ThreadRunner])
def test_a_jobs_error_is_raised_where_its_result_is_asked_for(runner):
    jobs, _ = jobs_with(runner())
    job = jobs.start(plugin_of(jobs).fail)
    with pytest.raises(ValueError, match="no"):
        job.result()
    jobs.close()


def test_against_the_wall_clock_a_job_is_ready_when_it_is_done():
    jobs, _ = jobs_with(InlineRunner(), is_lock_step=False, clock=WallClock())
    assert jobs.start(plugin_of(jobs).square, 3).is_ready()


def test_wall_times_are_kept_for_the_report(monkeypatch):
    jobs, _ = jobs_with(InlineRunner())
    plugin = plugin_of(jobs)
    times_s = iter([10.0, 10.25, 20.0, 20.5])
    monkeypatch.setattr("executive.mission.jobs.jobs.wall_s", lambda: next(times_s))
    for _ in range(2):
        jobs.start(plugin.square, 3)
    assert list(jobs.durations_ms["motion.square"]) == [250.0, 500.0]


def plugin_of(jobs):
    """Return the one plugin of these jobs."""
    return next(iter(jobs._plugins.values()))


def segment(cloud):
    """Return a task of the shipped segmenter."""
    plugin = load("segmentation", "ground_and_clusters")(
        settings_of("segmentation", "ground_and_clusters")()
    )
    address = Address.of("segmentation", "ground_and_clusters", plugin, "segment")
    return Task(address, plugin, VerbCall("segment", (cloud,), {}), 60.0)


def segmentation():
    settings = settings_of("segmentation", "ground_and_clusters")()
    return {"segmentation": (Selection("ground_and_clusters", settings),)}


def stones_on_a_plane():
    from executive.messages.cloud import Cloud

    rng = np.random.default_rng(3)
    ground = np.column_stack([rng.uniform(-5, 5, (20000, 2)), rng.normal(0, 0.01, 20000)])
    stone = rng.normal(size=(3000, 3))
    stone *= 0.5 / np.linalg.norm(stone, axis=1)[:, None]
    return Cloud("map", np.concatenate([ground, stone + [2, 1, 0.4], stone + [-2, 2, 0.4]]))


def test_a_worker_process_computes_what_the_inline_runner_computes():
    from executive.mission.assembly import assemble

    selections = segmentation()
    assembly = assemble(selections, "m545", 1)
    assembly.start()
    results = []
    for runner in (InlineRunner(), ThreadRunner(), ProcessRunner(selections, "m545", 1)):
        jobs = Jobs(assembly.plugins, runner, SimulatedClock(), is_lock_step=True)
        results.append(jobs.start(plugin_of(jobs).segment, stones_on_a_plane()).result())
        jobs.close()
    assembly.close()
    first = results[0]
    assert len(first.segments) == 2
    for other in results[1:]:
        assert [s.points.tobytes() for s in other.segments] == [
            s.points.tobytes() for s in first.segments
        ]


def test_a_worker_that_died_between_two_calls_is_replaced_and_told():
    told = []
    worker = Worker("segmentation", segmentation(), load_machine("m545"), 1, tell=told.append)
    try:
        assert worker.submit(segment(stones_on_a_plane())).result(60).segments
        worker._process.kill()
        assert worker.submit(segment(stones_on_a_plane())).result(60).segments
        assert [(one.name, one.verb) for one in told] == [("ground_and_clusters", "")]
    finally:
        worker.close()


@pytest.mark.parametrize("base", ["welded", "on_legs"])
def test_a_worker_has_the_machine_of_the_robot_that_it_does_not_make(monkeypatch, base):
    """A planner in a process of its own had taken a machine on legs for one that cannot tip."""
    machines = []

    def noted(capability, selections, machine, *more):
        assert "robot" not in selections
        machines.append(machine)
        return SimpleNamespace(prepare=lambda: None, close=lambda: None)

    monkeypatch.setattr(process_runner, "Worker", noted)
    robot = Selection("mujoco", settings_of("robot", "mujoco")(base=base))
    runner = ProcessRunner({**segmentation(), "robot": (robot,)}, "m545", 1)
    runner.prepare("segmentation")
    runner.close()
    assert [one.stance.is_free for one in machines] == [base == "on_legs"]


def test_an_error_in_a_worker_comes_back_as_it_is():
    from executive.errors import ExecutiveError

    worker = Worker("segmentation", segmentation(), load_machine("m545"), 1)
    try:
        with pytest.raises((ExecutiveError, AttributeError, TypeError)):
            worker.submit(segment(SimpleNamespace(points="nonsense"))).result(60)
    finally:
        worker.close()


def test_a_call_that_is_given_up_is_killed_at_its_deadline_and_the_next_is_served():
    from executive.messages.cloud import Cloud

    rng = np.random.default_rng(0)
    endless = Cloud("map", rng.uniform(-50, 50, (20_000_000, 3)))
    runner = ProcessRunner(segmentation(), "m545", 1)
    plugin = load("segmentation", "ground_and_clusters")(
        settings_of("segmentation", "ground_and_clusters")()
    )
    jobs = Jobs({"segmentation": plugin}, runner, WallClock(), is_lock_step=False)
    try:
        assert jobs.start(plugin_of(jobs).segment, stones_on_a_plane()).result().segments
        before = runner._workers["segmentation"]._process
        worker, job = (
            runner._workers["segmentation"],
            jobs.start(plugin_of(jobs).segment, endless),
        )
        while worker._computing is None:
            time.sleep(0.01)
        job.cancel()
        assert jobs.start(plugin_of(jobs).segment, stones_on_a_plane()).result().segments
        assert worker._process is not before
    finally:
        jobs.close()


class Queue(InlineRunner):
    """Computes nothing, and keeps which tasks are given up."""

    def __init__(self):
        super().__init__()
        self.futures, self.abandoned = [], []

    def submit(self, task):
        self.futures.append(Future())
        return self.futures[-1]

    def abandon(self, task, future):
        self.abandoned.append((task.call.verb, future))


def test_a_job_that_waits_is_taken_out_and_one_that_is_computed_is_given_up():
    runner = Queue()
    jobs, _ = jobs_with(runner)
    waiting, computed = (jobs.start(plugin_of(jobs).square, n) for n in (1, 2))
    runner.futures[1].set_running_or_notify_cancel()
    waiting.cancel()
    assert runner.futures[0].cancelled()
    assert not runner.abandoned
    computed.cancel()
    assert runner.abandoned == [("square", runner.futures[1])]
    jobs.close()


def test_in_lock_step_the_supervisor_waits_for_as_long_as_the_call_is_awaited() -> None:
    """On a busy computer a call that computes for its limit takes many times that on the wall."""
    address = Address("motion", "calculator", "square", "")
    task = Task(address, Calculator(), VerbCall("square", (7,), {}), 0.05, counts_computing=True)
    spent = iter([0.0, 0.02, 0.06])  # at the begin, and at two looks
    waited = task.patience(lambda: next(spent), float)
    with noted(task):
        time.sleep(0.1)
        assert beacon().overdue_s() > 0.0
        assert waited.more_s() > 0.0
        assert beacon().overdue_s() == 0.0
        time.sleep(0.1)
        assert waited.more_s() == 0.0
        assert beacon().overdue_s() > 0.0
