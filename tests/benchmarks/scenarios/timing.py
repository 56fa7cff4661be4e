"""How long the estimators take: an inertial sample at 100 Hz in real time, in turns, and an update
of the smoother.
"""

import gc
import os
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from unittest.mock import patch

import numpy as np
from executive_plugins.estimation.graph.smoother import GraphSmoother

from executive.interfaces.estimation import Estimator
from executive.machine.machine import Machine
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement
from scenarios import faults
from scenarios.motion import Kind, Motion
from scenarios.streams import LidarErrors, Message, stream
from scenarios.truth import RATE_HZ, Truth

BLOCK_S, BLOCKS, WARM_S = 3.0, 5, 10.0
Times = list[tuple[float, float]]  # wall and this thread's own [s]


class Lane:
    """One estimator and its stream, fed a block at a time."""

    def __init__(self, estimator: Estimator, machine: Machine, is_idle: bool = False) -> None:
        rng = np.random.default_rng(7)
        truth = Truth(machine, Motion.drawn(Kind.SWINGING, rng))
        messages = stream(
            truth, WARM_S + 2 * BLOCKS * BLOCK_S + 1.0, faults.none, LidarErrors(), rng
        )
        self._messages = self._without_measurements(messages) if is_idle else iter(messages)
        self._estimator = estimator
        estimator.start()
        self._until_s = WARM_S
        for arrival_s, message in self._messages:
            estimator.add(message)
            if arrival_s >= WARM_S:
                break

    @staticmethod
    def _without_measurements(
        messages: Sequence[tuple[float, Message]],
    ) -> Iterator[tuple[float, Message]]:
        """Leave corrections out after the start, so that propagation alone remains."""
        return (m for m in messages if m[0] < 4.0 or not isinstance(m[1], GnssFix | LidarIncrement))

    def block(self, is_awake: bool) -> Times:
        """Feed a block in real time; return how long each sample of the cabin's sensor took.

        Args:
            is_awake: Whether to wait for the next message without leaving the core, as a real-time
                thread of its own core would find it: its caches warm. A sleeper finds them as what
                else runs has left them.
        """
        times: Times = []
        offset_s = time.perf_counter() - self._until_s
        self._until_s += BLOCK_S
        for arrival_s, message in self._messages:
            _wait_until(arrival_s + offset_s, is_awake)
            if isinstance(message, ImuSample) and message.frame == "imu_cabin":
                wall_s, own_s = time.perf_counter(), time.thread_time()
                self._estimator.add_imu(message)
                self._estimator.state()
                times.append((time.perf_counter() - wall_s, time.thread_time() - own_s))
            else:
                self._estimator.add(message)
            if arrival_s >= self._until_s:
                break
        return times

    def close(self) -> None:
        """End the estimator."""
        self._estimator.close()


def _wait_until(when_s: float, is_awake: bool) -> None:
    if not is_awake:
        time.sleep(max(0.0, when_s - time.perf_counter()))
    while time.perf_counter() < when_s:
        pass


def service(
    makers: Mapping[str, Callable[[bool], Estimator]], machine: Machine
) -> dict[str, dict[str, list[float]]]:
    """Return figures of one value a block; the estimators take turns, so that a busy computer is
    busy for all.

    Args:
        makers: Of estimators, by name; `dual_graph` smooths in a process of its own if told so.
        machine: The machine.
    """
    lanes = {name: Lane(make(True), machine) for name, make in makers.items()}
    beside = {
        "idle": Lane(makers["dual_graph"](True), machine, is_idle=True),
        "in line": Lane(makers["dual_graph"](False), machine),
    }
    figures: dict[str, dict[str, list[float]]] = {name: defaultdict(list) for name in makers}
    gc.freeze()
    for block in range(2 * BLOCKS):
        is_awake = block % 2 == 0
        times = {name: np.array(lane.block(is_awake)) for name, lane in (lanes | beside).items()}
        for name in makers:
            _describe(figures[name], times[name], "awake" if is_awake else "asleep")
        if is_awake:
            for i, clock in enumerate(("wall", "thread")):
                idle_ms, own_ms, in_line_ms = (
                    1e3 * times[n][:, i].max() for n in ("idle", "dual_graph", "in line")
                )
                figures["dual_graph"][f"stall: {clock}"].append(own_ms - idle_ms)
                figures["dual_graph"][f"stall in line: {clock}"].append(in_line_ms - idle_ms)
    for lane in (lanes | beside).values():
        lane.close()
    return figures


def _describe(figures: dict[str, list[float]], times: np.ndarray, how: str) -> None:
    for i, clock in enumerate(("wall", "thread")):
        us = 1e6 * times[:, i]
        figures[f"service: mean, {clock}, {how}"].append(float(us.mean()))
        figures[f"service: p99, {clock}, {how}"].append(float(np.percentile(us, 99)))


def updates(
    make: Callable[[bool], Estimator], machine: Machine, seconds: float = 30.0
) -> dict[str, list[float]]:
    """Return the 99th percentile of an update's duration, a value for each two seconds, after the
    window is full.
    """
    times: Times = []
    update = GraphSmoother.update

    def timed(smoother: GraphSmoother) -> object:
        wall_s, own_s = time.perf_counter(), time.thread_time()
        estimate = update(smoother)
        times.append((time.perf_counter() - wall_s, time.thread_time() - own_s))
        return estimate

    rng = np.random.default_rng(8)
    truth = Truth(machine, Motion.drawn(Kind.SWINGING, rng))
    estimator = make(False)
    estimator.start()
    with patch.object(GraphSmoother, "update", timed):
        for _, message in stream(truth, seconds, faults.none, LidarErrors(), rng):
            estimator.add(message)
    full = 1e3 * np.array(times[len(times) // 4 :])
    rate_hz = len(times) / seconds
    parts = np.array_split(full, max(1, len(full) // 100))
    return {
        "update: p99, wall": [float(np.percentile(part[:, 0], 99)) for part in parts],
        "update: p99, thread": [float(np.percentile(part[:, 1], 99)) for part in parts],
        "update: mean, thread": [float(part[:, 1].mean()) for part in parts],
        "update: rate": [rate_hz],
    }


def computer() -> str:
    """Say how busy the computer is, and by how much it slows down who sleeps between two
    samples.
    """
    awake_us, asleep_us = (1e6 * float(np.median(_probe(is_awake))) for is_awake in (True, False))
    return (
        f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores, samples at {RATE_HZ} "
        "Hz; reading the thread's clock "
        f"costs {1e6 * _clock_s():.1f} µs; some NumPy work takes {awake_us:.0f} µs "
        f"awake, {asleep_us:.0f} µs after "
        "each sleep of 10 ms"
    )


def _probe(is_awake: bool) -> list[float]:
    times, a = [], np.eye(3)
    for _ in range(300):
        _wait_until(time.perf_counter() + (0.0 if is_awake else 0.01), is_awake)
        own_s = time.thread_time()
        for _ in range(10):
            a = a @ a
        times.append(time.thread_time() - own_s)
    return times


def _clock_s() -> float:
    begun_s = time.thread_time()
    for _ in range(1000):
        time.thread_time()
    return (time.thread_time() - begun_s) / 1000
