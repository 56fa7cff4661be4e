"""Signals of a run: each is counted, the second ends it, and what was there before comes back."""

import os
import signal
import threading
from typing import Any

import pytest

from executive.mission.interrupts import stop_on_interrupt
from executive.mission.stop_signals import Aborted, stop_after_report, stop_at_once, stopping
from executive.supervision.early_stop import STOPPING, TOLD, take_defaults


class Mission:
    """Keeps what it is asked for."""

    def __init__(self) -> None:
        self.asked: list[str] = []

    def request_stop(self) -> None:
        self.asked.append("stop")

    def toggle_pause(self) -> None:
        self.asked.append("pause")


def send(number: int) -> None:
    os.kill(os.getpid(), number)


def test_each_request_is_counted_and_the_handlers_come_back() -> None:
    before = [signal.getsignal(number) for number in STOPPING]
    taken: list[int] = []
    with stopping(taken.append):
        for number in STOPPING:
            send(number)
        assert taken == [1, 2, 3]
    assert [signal.getsignal(number) for number in STOPPING] == before
    with pytest.raises(KeyError), stopping(taken.append):
        raise KeyError
    assert [signal.getsignal(number) for number in STOPPING] == before


def test_the_first_request_stops_a_mission_and_the_second_ends_it() -> None:
    mission, before = Mission(), signal.getsignal(signal.SIGUSR1)
    at_once = pytest.raises(Aborted, match="stopped at once by the operator")
    with at_once, stop_on_interrupt(mission):
        send(signal.SIGUSR1)
        send(signal.SIGTERM)
        assert mission.asked == ["pause", "stop"]
        send(signal.SIGINT)
    assert mission.asked == ["pause", "stop"]
    assert signal.getsignal(signal.SIGUSR1) is before


def test_another_thread_than_the_first_takes_no_signals() -> None:
    before = [signal.getsignal(number) for number in (*STOPPING, signal.SIGUSR1)]
    found: list[Any] = []

    def work() -> None:
        with stop_on_interrupt(Mission()):
            found.extend(signal.getsignal(number) for number in (*STOPPING, signal.SIGUSR1))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert found == before


def test_what_a_request_does_depends_on_how_far_the_run_is() -> None:
    with pytest.raises(Aborted, match=TOLD):
        stop_at_once(1)
    stop_after_report(1)
    with pytest.raises(Aborted, match="stopped while the report was written"):
        stop_after_report(2)


def test_a_tool_takes_signals_as_any_program_does(monkeypatch: pytest.MonkeyPatch) -> None:
    taken: dict[int, Any] = {}
    monkeypatch.setattr(signal, "signal", taken.__setitem__)
    take_defaults()
    assert taken == {
        signal.SIGINT: signal.default_int_handler,
        signal.SIGTERM: signal.SIG_DFL,
        signal.SIGHUP: signal.SIG_DFL,
    }
