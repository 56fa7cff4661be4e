"""What one process writes into the shared block without pause, another one never reads mixed."""

import os
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import get_context

import numpy as np
import pytest
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial, InertialState
from executive_plugins.estimation.live.estimate import Estimate
from executive_plugins.estimation.live.kernels import step
from executive_plugins.estimation.live.layout import ANSWERS, LIVE, SAMPLES
from executive_plugins.estimation.live.modes import Mode
from executive_plugins.estimation.live.packed_state import ROW
from executive_plugins.estimation.live.packing import pack_into, samples_from
from executive_plugins.estimation.live.propagator import LivePropagator
from executive_plugins.estimation.start.chassis import TurnJoint
from typing_extensions import Buffer

from executive.machine.machine import Machine

LOOK_S = 1.0  # of hammering
VAIN_S = 60.0  # a loaded computer may hold up each look for so long that nothing is left to see
STEP_S = 1e-3
NOISE = InertialNoise(2e-3, 3e-2, 4e-4, 5e-3, 0.1, 9.81, 0.01)


@pytest.fixture
def memory() -> Buffer:
    found: Buffer = get_context("spawn").RawArray("b", LIVE.itemsize)
    return found


@contextmanager
def writing(write: Callable[[int], None], first: int) -> Iterator[None]:
    """Let a process call a function with rising numbers, without pause."""
    writer = os.fork()
    while not writer:
        write(first)
        first += 1
    try:
        yield
    finally:
        os.kill(writer, signal.SIGKILL)
        os.waitpid(writer, 0)


def until_over(is_enough: Callable[[], bool] = lambda: True) -> Iterator[int]:
    """Count looks until the time is over, at least three, and until they are enough or in vain."""
    start_s, looks = time.monotonic(), 0
    while looks < 3 or time.monotonic() < start_s + LOOK_S or not is_enough():
        assert time.monotonic() < start_s + VAIN_S, "no look showed anything"
        looks += 1
        yield looks


def test_a_reader_that_lags_gets_no_sample_that_is_written_over(memory: Buffer) -> None:
    block, row = np.frombuffer(memoryview(memory), LIVE, 1), np.zeros(1, ROW)
    block["gap_s"] = 1.0

    def write(number: int) -> None:
        same = np.full(3, (number % 1000) / 100)
        step(block, STEP_S * number, same, same, row)
        block["published"][0] = number

    for number in range(1, SAMPLES + 100):
        write(number)
    seen: list[int] = []
    with writing(write, SAMPLES + 100):
        for _ in until_over(lambda: bool(seen)):
            end = int(block["published"][0])
            while block["published"][0] < end + 20:  # held up: further samples are written
                time.sleep(0.001)
            got = samples_from(block, end - SAMPLES, end)[:200]
            if not got:
                continue  # held up for so long that all that was asked for is written over
            seen.append(len(got))
            numbers = [round(one.stamp_s / STEP_S) for one in got]
            assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
            for one, number in zip(got, numbers, strict=True):
                same = [(number % 1000) / 100] * 3
                assert (one.rate.tolist(), one.force.tolist()) == (same, same)


def test_an_estimate_is_taken_whole_by_a_process_that_was_held_up(
    memory: Buffer, machine: Machine
) -> None:
    propagator = LivePropagator(np.eye(4), TurnJoint(machine), NOISE, 1.0, memory)
    propagator.epoch = 1
    block = propagator.block

    def answer(number: int) -> None:
        row = block["answers"][0][number % ANSWERS : number % ANSWERS + 1]
        same, at = np.full(3, float(number)), Inertial(1.0, np.zeros(3), np.zeros(3), 0.01)
        state = InertialState(at, np.eye(3), same, same, same, same)
        pack_into(row, Estimate(state, number * np.eye(15), Mode.GLOBAL, (), {}))
        row["epoch"], row["messages"] = 1, number
        block["answered"][0] = number

    for number in range(1, ANSWERS + 1):
        answer(number)
    with writing(answer, ANSWERS + 1):
        for _ in until_over():
            number = int(block["answered"][0])
            time.sleep(0.002)  # held up: further estimates are written
            _, messages = propagator.take_answer(number)
            taken = [*block["p"][0], *block["v"][0], *block["gyro_bias"][0], messages]
            assert set(taken) == {messages}
            assert messages >= number
            assert block["from_P"][0][14, 14] == messages
