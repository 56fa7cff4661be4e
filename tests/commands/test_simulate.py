"""`executive simulate`: how long it waits, when it keeps the world, and who surveys its site."""

import contextlib
import json
import signal
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from executive import registry
from executive.commands.missions.simulate import _silence_s, _surveys, _tended, simulate
from executive.errors import ConfigError
from executive.interfaces.facilities import SurveyedAside


@pytest.mark.parametrize(
    ("text", "seconds"), [("0.3 s", 0.3), ("300 ms", 0.3), ("2", 2.0), ("0.05", 0.05)]
)
def test_a_silence_is_a_time_with_or_without_its_unit(text, seconds):
    assert _silence_s(text) == pytest.approx(seconds, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "told"),
    [("0.04 s", r"--silence: at least 0\.05 s, got 0\.04 s"), ("3 m", "--silence: "),
     ("soon", "--silence: ")],
)  # fmt: skip
def test_a_silence_that_is_too_short_or_no_time_is_refused(text, told):
    with pytest.raises(ConfigError, match=told):
        _silence_s(text)


def test_the_world_is_kept_every_half_second_of_its_time():
    kept = []
    tend = _tended(SimpleNamespace(keep=kept.append))
    for time_s in (0.0, 0.25, 0.5, 0.75, 1.125, 1.5, 1.625):
        tend(SimpleNamespace(time_s=time_s, alone_s=0.0, is_ended=False))
    assert kept == [0.0, 0.5, 1.125, 1.625]


def test_a_disk_that_is_full_is_told_once_and_ends_no_machine(caplog):
    def keep(_time_s):
        raise OSError(28, "No space left on device")

    tend = _tended(SimpleNamespace(keep=keep))
    server = SimpleNamespace(time_s=0.0, alone_s=0.0, is_ended=False)
    for server.time_s in (0.0, 0.5, 1.0):
        tend(server)
    assert not server.is_ended
    assert caplog.messages == ["the world cannot be kept: No space left on device"]


@pytest.mark.parametrize(
    ("alone_s", "was_ended", "is_ended"),
    [(60.0, False, False), (60.1, False, True), (0.0, True, True)],
)
def test_a_machine_that_nobody_drives_for_a_minute_ends(alone_s, was_ended, is_ended):
    server = SimpleNamespace(time_s=0.0, alone_s=alone_s, is_ended=was_ended)
    _tended(SimpleNamespace(keep=lambda time_s: None))(server)
    assert server.is_ended == is_ended


class Robot(SurveyedAside):
    """A site that can be surveyed aside, and counts how often it was asked for."""

    copies = 0

    def site_now(self):
        self.copies += 1
        return f"site {self.copies}"


Robot.__abstractmethods__ = frozenset()


@pytest.fixture
def surveyor(monkeypatch):
    """The class of a surveying plugin that is installed; what it does is kept in `told`."""

    class Surveyor:
        told = []
        dependencies = ("robot",)

        def __init__(self, settings, *, robot):
            self.name = robot if isinstance(robot, str) else "first"
            self.settings = settings

        def start(self):
            self.told.append((self.name, "start"))

        def survey(self, rng):
            self.told.append((self.name, self.settings, rng.integers(10**9)))
            return f"survey of {self.name}"

        def close(self):
            self.told.append((self.name, "close"))

    monkeypatch.setattr(registry, "load", lambda capability, name: Surveyor)
    monkeypatch.setattr(registry, "dependencies_of", lambda plugin: plugin.dependencies)
    return Surveyor


CHOSEN = {"surveying": (SimpleNamespace(name="drone", settings="the settings"),)}


def test_each_survey_is_of_the_site_as_it_was_when_it_was_begun(surveyor):
    begin = _surveys(CHOSEN, Robot())
    assert surveyor.told == [("first", "start"), ("first", "close")]
    surveyor.told.clear()
    first, second = begin(3), begin(4)
    assert [second(), first()] == ["survey of site 2", "survey of site 1"]
    draws = [np.random.default_rng(seed).integers(10**9) for seed in (4, 3)]
    assert surveyor.told == [
        ("site 2", "start"), ("site 2", "the settings", draws[0]), ("site 2", "close"),
        ("site 1", "start"), ("site 1", "the settings", draws[1]), ("site 1", "close"),
    ]  # fmt: skip


def test_a_survey_that_fails_closes_its_plugin(surveyor, monkeypatch):
    survey = _surveys(CHOSEN, Robot())(3)

    def fail(self, rng):
        raise LookupError

    monkeypatch.setattr(surveyor, "survey", fail)
    with pytest.raises(LookupError):
        survey()
    assert surveyor.told[-1] == ("site 1", "close")


def test_without_what_surveys_the_site_alone_there_is_no_survey(surveyor):
    assert _surveys({}, Robot()) is None
    assert _surveys(CHOSEN, object()) is None
    surveyor.dependencies = ("robot", "mapping")
    assert _surveys(CHOSEN, Robot()) is None
    assert surveyor.told == []


class Server:
    """Runs until each signal was handled."""

    def __init__(self, machine, robot, model, address, silence_s, simulation):
        self.machine, self.address, self.time_s, self.is_ended = machine, address, 12.5, False
        self.given = robot, model, silence_s, simulation
        machine.server = self

    def run(self):
        self.machine.told.append("run")
        for number, handler in self.machine.handlers.items():
            self.is_ended = False
            handler(number, None)
            assert self.is_ended
        if self.machine.fails:
            raise self.machine.fails


class Keeper:
    """Tells what it is asked for."""

    def __init__(self, tell, folder, robot):
        self.tell = tell
        tell(("keeper", folder.path, robot))

    def restore(self):
        return 7.5

    def keep(self, time_s):
        self.tell(("keep", time_s))

    def end(self, time_s):
        self.tell(("end", time_s))


class Machine:
    """The process of a machine: its parts are made up, and what happens is told in order."""

    def __init__(self, monkeypatch, robot="mujoco"):
        self.told, self.server, self.fails = [], None, None
        self.plugins = {"robot": [SimpleNamespace(name=robot)]}
        tell = self.told.append
        assembly = SimpleNamespace(
            start=lambda: tell("start"), close=lambda: tell("close"), plugins={"robot": "the robot"}
        )

        self.handlers = {}
        description = SimpleNamespace(plugins=self.plugins)
        for name, value in {
            "mission.assembly.assemble": lambda *given: tell(given) or assembly,
            "mission.assembly.needed_for": lambda plugins, key: f"what a {key} needs",
            "mission.machine_folder.WorldKeeper": partial(Keeper, tell),
            "mission.selections.model_of": lambda description: "mini",
            "tree.load.load_mission": lambda mission, set_: tell((mission, set_)) or description,
            "wire.machine_server.MachineServer": partial(Server, self),
        }.items():
            monkeypatch.setattr(f"executive.{name}", value)
        monkeypatch.setattr("signal.signal", self.handlers.__setitem__)
        monkeypatch.setattr("sys.setswitchinterval", lambda s: tell(("switch", s)))
        monkeypatch.setattr("logging.basicConfig", lambda **_: None)


def test_a_machine_lives_until_a_signal_ends_it(monkeypatch, capsys, tmp_path):
    machine, path = Machine(monkeypatch), tmp_path / "machine.sock"
    path.touch()
    simulate("map_site", f"unix:{path}", ["a=1"], 5, "0.4 s", None, True)
    assert machine.told == [
        ("map_site", ["a=1"]), ("what a robot needs", "mini", 5), ("switch", 5e-4), "start", "run",
        "close",
    ]  # fmt: skip
    assert set(machine.handlers) == {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}
    robot, model, silence_s, simulation = machine.server.given
    assert (robot, model, silence_s) == ("the robot", "mini", 0.4)
    assert (simulation.survey, simulation.begins_s) == (None, 0.0)
    simulation.tend(machine.server)
    told = capsys.readouterr()
    assert told.err == f"machine 'mini' listens at unix:{path}; Ctrl-C ends it\n"
    answered = {"address": f"unix:{path}", "model": "mini", "silence_s": 0.4}
    assert json.loads(told.out) == answered
    assert not path.exists()


@pytest.mark.parametrize("fails", [None, LookupError("lost")])
def test_a_machine_of_a_run_goes_on_where_it_was_and_leaves_what_happened(
    monkeypatch, capsys, tmp_path, fails
):
    machine = Machine(monkeypatch)
    machine.fails = fails
    ended = pytest.raises(LookupError) if fails else contextlib.nullcontext()
    with ended:
        simulate("map_site", run_dir=tmp_path)
    assert machine.told[0] == ("map_site", ())
    assert machine.told[1][2] == 1
    assert machine.told[3:] == [
        "start", ("keeper", tmp_path, "the robot"), "run", ("end", 12.5), "close"
    ]  # fmt: skip
    simulation = machine.server.given[3]
    assert simulation.begins_s == 7.5
    machine.server.alone_s = 0.0
    simulation.tend(machine.server)
    assert machine.told[-1] == ("keep", 12.5)
    assert machine.server.given[2] == 0.3
    assert capsys.readouterr().out == ""


def test_the_machine_of_another_process_is_not_simulated(monkeypatch):
    Machine(monkeypatch, robot="wire")
    with pytest.raises(ConfigError, match="the robot 'wire' is another process's"):
        simulate("map_site")
