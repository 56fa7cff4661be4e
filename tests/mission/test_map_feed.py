"""On the wall clock scan pairs are fused in a thread, in order, and the tick does not wait."""

import threading

import numpy as np
import pytest

from executive.clock import SimulatedClock, WallClock
from executive.interfaces.mapping import Mapper
from executive.messages.cloud import Cloud
from executive.mission.jobs.jobs import Jobs
from executive.mission.jobs.process_runner import ProcessRunner
from executive.mission.jobs.thread_runner import ThreadRunner
from executive.mission.streams import Streams
from tests.mission.test_streams import Guarded, Listener, ToldEstimator, moved, scan

WAIT_S = 60.0


class SlowMapper(Mapper):
    """Fuses a pair when a test lets it; a cloud tells how many there were."""

    beside_tick = ("add_scan_pair", "cloud")
    fails = False

    def __init__(self):
        self.may_fuse = threading.Semaphore(0)
        self.stamps, self.threads = [], []

    def add_scan_pair(self, scans, motion):
        assert self.may_fuse.acquire(timeout=WAIT_S)
        self.threads.append(threading.current_thread())
        if self.fails:
            raise RuntimeError("no map")
        self.stamps.append(scans[0].stamp_s)
        return 2

    def cloud(self):
        return Cloud("map", np.zeros((len(self.stamps), 3)))

    def mask_held(self, radius_m):
        """Do nothing."""

    held = cloud

    def remove_sphere(self, centre_map, radius_m):
        return 0

    def add_surface(self, points_map):
        """Do nothing."""

    def dense_share(self, sector, points_per_m2):
        return 0.0


class InTheTick(SlowMapper):
    beside_tick = ()


class Counting(Guarded):
    """Keeps how many pairs were behind."""

    def __init__(self):
        super().__init__()
        self.behind = []

    def may_fuse(self, stamp_s, behind=0):
        self.behind.append(behind)
        return behind < 2


RUNNERS = pytest.mark.parametrize(
    "runner", [ThreadRunner, lambda: ProcessRunner({}, "m545", 1)], ids=["thread", "process"]
)


@pytest.fixture
def begin():
    """Return a function that makes streams, their listener, and jobs, and closes these at last."""
    made = []

    def begin(mapper, runner=ThreadRunner, guard=None, *, is_lock_step=False):
        estimator, listener = ToldEstimator(), Listener([])
        estimator.status = "GLOBAL"
        plugins = {"estimation": estimator, "mapping": mapper}
        clock = SimulatedClock() if is_lock_step else WallClock()
        jobs = Jobs(plugins, runner(), clock, is_lock_step=is_lock_step)
        made.append(jobs)
        streams = Streams(plugins, ("left", "right"), listener, guard, jobs)
        moved(streams, estimator, 1.0, 1.5)
        return streams, listener, jobs

    yield begin
    for jobs in made:
        jobs.close()


def pair(stamp_s):
    return [scan(stamp_s, "left"), scan(stamp_s, "right")]


@RUNNERS
def test_the_tick_does_not_wait_and_a_later_cloud_holds_every_pair(begin, runner):
    mapper = SlowMapper()
    streams, _, jobs = begin(mapper, runner)
    for stamp_s in (1.6, 1.7, 1.8):
        streams.process(pair(stamp_s))  # would wait for a minute and fail within the tick
    assert (mapper.stamps, streams.scan_pairs) == ([], 0)
    job = jobs.start(mapper.cloud)
    assert not job.is_ready()
    mapper.may_fuse.release(3)
    assert len(job.result()) == 3
    assert mapper.stamps == [1.6, 1.7, 1.8]
    streams.process([])
    assert streams.scan_pairs == 3
    assert threading.current_thread() not in mapper.threads
    assert len(jobs.durations_ms["mapping.add_scan_pair"]) == 3


def test_at_the_end_the_map_waits_for_what_is_on_its_way(begin):
    mapper = SlowMapper()
    streams, _, _ = begin(mapper)
    streams.process(pair(1.6))
    threading.Timer(0.05, mapper.may_fuse.release).start()
    streams.settle()
    assert (mapper.stamps, streams.scan_pairs) == ([1.6], 1)


def test_an_error_is_told_and_no_further_pair_is_sent(begin):
    mapper = SlowMapper()
    mapper.fails = True
    streams, listener, _ = begin(mapper)
    streams.process(pair(1.6))
    streams.process(pair(1.7))
    mapper.may_fuse.release(9)
    streams.settle()
    streams.process(pair(1.8))
    streams.settle()
    assert listener.errors == [("mapping", "no map")]
    assert (streams.scan_pairs, mapper.stamps) == (0, [])


def test_the_guard_is_told_how_far_the_map_is_behind(begin):
    mapper, guard = SlowMapper(), Counting()
    streams, _, _ = begin(mapper, guard=guard)
    for stamp_s in (1.6, 1.7, 1.8):
        streams.process(pair(stamp_s))
    assert guard.behind == [0, 1, 2]
    mapper.may_fuse.release(3)
    streams.settle()
    assert mapper.stamps == [1.6, 1.7]


@pytest.mark.parametrize(
    ("kind", "is_lock_step"), [(SlowMapper, True), (InTheTick, True), (InTheTick, False)]
)
def test_in_lock_step_and_of_other_mappers_the_tick_fuses_it(begin, kind, is_lock_step):
    mapper = kind()
    mapper.may_fuse.release()
    streams, _, _ = begin(mapper, is_lock_step=is_lock_step)
    streams.process(pair(1.6))
    assert (mapper.stamps, streams.scan_pairs) == ([1.6], 1)
    assert mapper.threads == [threading.current_thread()]
