"""The work of a trial is found by its name, and its arguments and inputs are checked before."""

from pathlib import Path

import pytest

from executive import registry
from executive.campaign.execution.chosen_work import inputs_of, work_of
from executive.campaign.trial import Limits, Trial
from executive.config import NoSettings, Settings
from executive.errors import ConfigError
from executive.interfaces.plugin import Plugin
from executive.interfaces.work import Work


class Lifting(Settings):
    count: int = 1
    log: Path = Path("none")


class Lift(Work):
    """A work that reads a log."""

    Arguments = Lifting

    def inputs(self, arguments):
        return {"log": arguments.log}

    def run(self, piece):
        raise NotImplementedError


def trial(**arguments):
    return Trial(0, "lift", arguments, 1, {}, Limits(60.0, 10**9))


@pytest.fixture
def installed(monkeypatch):
    monkeypatch.setattr(registry, "load", lambda group, name: {"lift": Lift}[name])


def test_a_work_is_given_with_its_checked_arguments(installed):
    work, arguments = work_of(trial(count=3))
    assert isinstance(work, Lift)
    assert arguments == Lifting(count=3)


def test_all_arguments_that_are_wrong_are_told(installed):
    with pytest.raises(ConfigError) as caught:
        work_of(trial(count="many", weight=3))
    told = str(caught.value)
    assert told.startswith("work 'lift' refuses its arguments: ")
    assert "count: " in told
    assert "; weight: " in told


def test_what_is_no_work_is_refused(monkeypatch):
    monkeypatch.setattr(registry, "load", lambda group, name: Plugin)
    with pytest.raises(ConfigError, match="work 'lift': Plugin does not derive from Work"):
        work_of(trial())


def test_inputs_have_to_be_there(installed, tmp_path):
    log = tmp_path / "a.mcap"
    with pytest.raises(ConfigError, match=f"its input 'log' does not exist: {log}"):
        inputs_of(trial(log=log))
    log.touch()
    assert inputs_of(trial(log=log)) == {"log": log}


def test_a_work_without_arguments_takes_none(monkeypatch):
    bare = type("Bare", (Work,), {"run": lambda self, piece: None, "Arguments": NoSettings})
    monkeypatch.setattr(registry, "load", lambda group, name: bare)
    assert inputs_of(trial()) == {}
    with pytest.raises(ConfigError, match="refuses its arguments: count: "):
        work_of(trial(count=1))
