"""`executive simulate`: how long it waits, when it keeps the world, and who surveys its site."""

from types import SimpleNamespace

import numpy as np
import pytest

from executive import registry
from executive.commands.missions.simulate import _silence_s, _surveys, _tended
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
