"""The worker's end of a worker process, in this process: what it sends for each call."""

import pickle
import signal
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from executive.errors import ConfigError, RobotError
from executive.faults.description import PluginFault
from executive.faults.plugin_faults import InjectedError
from executive.machine.machine import load_machine
from executive.mission.fault import REMOTE
from executive.mission.jobs import faulty_call, serving
from executive.mission.jobs.call import NotPortableError, VerbCall
from executive.mission.jobs.faulty_call import DecidedCall, decided

MACHINE = load_machine("m545")


class Plugin:
    """Doubles numbers, and fails in several ways."""

    is_stateless = True

    def twice(self, number: float, more: float = 0.0) -> float:
        return 2.0 * number + more

    def fails(self) -> None:
        raise KeyError("no such stone")

    def ends(self) -> None:
        raise SystemExit(3)

    def local(self) -> Any:
        return lambda: None

    def own(self) -> None:
        raise UnportableError("a", "b")


class UnportableError(Exception):
    """Cannot be pickled, as it holds a function."""

    def __init__(self, first: str, second: str) -> None:
        super().__init__(first + second)
        self.join = lambda: first + second


class Assembly:
    """One plugin, made and started as a test says."""

    def __init__(self, fails: BaseException | None = None) -> None:
        self.plugins = {"motion": Plugin()}
        self.fails = fails
        self.is_closed = False

    def start(self) -> None:
        if self.fails is not None:
            raise self.fails

    def close(self) -> None:
        self.is_closed = True


class Connection:
    """Sends what a test asks, and keeps what is answered."""

    def __init__(self, *calls: VerbCall) -> None:
        self.calls = list(calls)
        self.sent: list[Any] = []

    def recv_bytes(self) -> bytes:
        if not self.calls:
            raise EOFError
        return pickle.dumps(self.calls.pop(0))

    def send_bytes(self, data: bytes) -> None:
        self.sent.append(pickle.loads(data))


@pytest.fixture
def assembly(monkeypatch: pytest.MonkeyPatch) -> Assembly:
    made = Assembly()
    name_of = lambda plugins: [("motion", "doubler", one) for one in plugins.values()]
    monkeypatch.setattr(serving, "selected_plugins", name_of)
    monkeypatch.setattr("executive.mission.fault.selected_plugins", name_of)
    monkeypatch.setattr(serving, "assemble_for", lambda machine, selections, seed: made)
    return made


def asked(verb: str, assembly: Assembly, *args: Any, **kwargs: Any) -> tuple[bool, Any]:
    call, plugin = VerbCall(verb, args, kwargs), assembly.plugins["motion"]
    return pickle.loads(serving._answer(call, plugin, "motion", assembly))


def test_an_answer_is_sent_with_the_word_that_it_is_no_error(assembly: Assembly) -> None:
    assert asked("twice", assembly, 3.0, more=0.5) == (False, 6.5)


def test_what_a_verb_raises_is_sent_with_plugin_verb_and_place(assembly: Assembly) -> None:
    is_error, error = asked("fails", assembly)
    assert is_error
    assert isinstance(error, KeyError)
    fault = getattr(error, REMOTE)
    assert (fault.component, fault.verb) == ("motion plugin 'doubler'", "fails")
    line = Plugin.fails.__code__.co_firstlineno + 1
    assert fault.place.endswith(f"test_serving.py:{line}")


def test_an_answer_that_cannot_be_sent_names_the_verb(assembly: Assembly) -> None:
    is_error, error = asked("local", assembly)
    assert is_error
    assert isinstance(error, NotPortableError)
    told = "'local' of the motion plugin 'doubler': its answer cannot be sent: "
    assert str(error).startswith(told)
    assert getattr(error, REMOTE).verb == "local"


def test_an_error_that_cannot_be_sent_is_told_by_its_type_and_text(assembly: Assembly) -> None:
    is_error, error = asked("own", assembly)
    assert is_error
    assert type(error) is RobotError
    assert str(error) == "UnportableError: ab"
    assert getattr(error, REMOTE).verb == "own"


def test_a_verb_that_exits_does_not_end_the_worker(assembly: Assembly) -> None:
    is_error, error = asked("ends", assembly)
    assert is_error
    assert "it called sys.exit(3)" in str(error)


def test_a_failed_start_is_told_by_its_error(
    assembly: Assembly, monkeypatch: pytest.MonkeyPatch
) -> None:
    for error, kind, told in (
        (ConfigError("no mesh"), ConfigError, "no mesh"),
        (SystemExit(4), RobotError, r"it called sys\.exit\(4\)"),
    ):
        assembly.fails, connection = error, Connection()
        assert serving._started(connection, {}, "m545", 1) is None
        (sent,) = connection.sent
        assert type(sent) is kind
        with pytest.raises(kind, match=told):
            raise sent
        assert getattr(sent, REMOTE) is not None


@pytest.fixture
def limits(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What is set up before the first call, in order."""
    done: list[Any] = []
    monkeypatch.setattr(serving, "_live_and_die_with_the_mission", lambda: done.append("signals"))
    monkeypatch.setattr(serving, "MemoryLimit", done.append)
    monkeypatch.setattr(serving, "spare_what_is_made", lambda: done.append("collector"))
    monkeypatch.setattr(serving.faulthandler, "enable", lambda file: done.append(file.name))
    monkeypatch.setattr(
        serving.faulthandler,
        "register",
        lambda number, file, all_threads: done.append((number, file.name, all_threads)),
    )
    return done


def test_calls_are_answered_until_the_connection_is_closed(
    assembly: Assembly, limits: list[Any], tmp_path: Path
) -> None:
    stack = tmp_path / "stack.txt"
    connection = Connection(VerbCall("twice", [1.0], {}), VerbCall("twice", [2.0], {}))
    serving.serve(connection, "motion", {}, MACHINE, 1, 10**9, stack)
    assert connection.sent == [None, (False, 2.0), (False, 4.0)]
    assert assembly.is_closed
    usr1 = (signal.SIGUSR1, str(stack), False)
    assert limits == ["signals", str(stack), usr1, 10**9, "collector"]


def test_a_worker_says_that_it_is_ready_when_it_is(
    assembly: Assembly, limits: list[Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    connection, sent_before = Connection(), []
    collector = lambda: sent_before.extend(connection.sent)
    monkeypatch.setattr(serving, "spare_what_is_made", collector)
    serving.serve(connection, "motion", {}, MACHINE, 1, 10**9, tmp_path / "stack.txt")
    assert sent_before == []
    assert connection.sent == [None]


def test_a_plugin_that_does_not_start_is_asked_nothing(
    assembly: Assembly, limits: list[Any], tmp_path: Path
) -> None:
    assembly.fails = ConfigError("no mesh")
    connection = Connection(VerbCall("twice", [1.0], {}))
    serving.serve(connection, "motion", {}, MACHINE, 1, 10**9, tmp_path / "stack.txt")
    assert len(connection.sent) == 1
    assert not {10**9, "collector"} & set(limits)


@pytest.mark.parametrize(("parent", "exits"), [(4711, []), (1, [1])])
def test_a_worker_ends_with_its_mission_and_leaves_ctrl_c_to_it(
    monkeypatch: pytest.MonkeyPatch, parent: int, exits: list[int]
) -> None:
    asked: list[Any] = []
    ended: list[int] = []
    library = SimpleNamespace(prctl=lambda *given: asked.append(given))
    monkeypatch.setattr(serving.ctypes, "CDLL", lambda name: library)
    monkeypatch.setattr(signal, "signal", lambda *given: asked.append(given))
    monkeypatch.setattr(serving.os, "getppid", lambda: parent)
    monkeypatch.setattr(serving.os, "_exit", ended.append)
    serving._live_and_die_with_the_mission()
    # prctl(2): 1 is PR_SET_PDEATHSIG.
    assert asked == [(signal.SIGINT, signal.SIG_IGN), (1, signal.SIGKILL)]
    assert ended == exits


CALL = VerbCall("twice", [3.0], {"more": 1.0})


def fault(how: str, delay: float | None = None) -> PluginFault:
    return PluginFault.model_construct(how=how, delay=delay)


def test_without_a_fault_the_verb_does_its_work_once() -> None:
    call = decided(CALL, None, is_lock_step=True)
    assert call == DecidedCall("twice", [3.0], {"more": 1.0}, "", 0.0, 0.0)
    plugin = Plugin()
    plugin.twice = None  # what decides, on the object itself, is not asked again
    assert call.of(plugin) == 7.0


@pytest.mark.parametrize(
    ("delay", "is_lock_step", "sleeps_s", "charged_s"),
    [
        (0.4, True, 0.0, 0.4),
        (0.4, False, 0.4, 0.0),
        (None, True, 0.0, faulty_call.DELAY_S),
        (None, False, faulty_call.DELAY_S, 0.0),
    ],
)
def test_a_late_answer_costs_mission_time_in_lock_step_and_sleep_else(
    delay: float | None, is_lock_step: bool, sleeps_s: float, charged_s: float
) -> None:
    call = decided(CALL, fault("late", delay), is_lock_step=is_lock_step)
    assert (call.how, call.sleeps_s, call.charged_s) == ("late", sleeps_s, charged_s)


def test_a_late_answer_is_the_answer_after_its_sleep(monkeypatch: pytest.MonkeyPatch) -> None:
    slept: list[float] = []
    clock = SimpleNamespace(sleep=slept.append)
    monkeypatch.setattr("executive.faults.plugin_faults.time", clock)
    call = decided(CALL, fault("late", 0.4), is_lock_step=False)
    assert call.of(Plugin()) == 7.0
    assert slept == [0.4]


def test_another_fault_takes_no_time_and_does_what_it_says() -> None:
    call = decided(CALL, fault("raise", 0.4), is_lock_step=True)
    assert (call.sleeps_s, call.charged_s) == (0.0, 0.0)
    with pytest.raises(InjectedError):
        call.of(Plugin())
