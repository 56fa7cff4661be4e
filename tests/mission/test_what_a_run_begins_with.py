"""The lock of a run's folder, how it was started, and what a mission selects."""

import os
from types import SimpleNamespace

import pytest

from executive.config import NoSettings
from executive.errors import ConfigError, DataError, RobotError
from executive.events.mission import PauseEnded
from executive.interfaces.robot import RobotSettings
from executive.journal import Journal
from executive.mission import selections
from executive.mission.record.journal_view import reading
from executive.mission.record.run_options import KeptOptions
from executive.mission.run_folder import RunFolder
from executive.mission.run_lock import RunLock
from executive.mission.selections import assembled, model_of

OPTIONS = KeptOptions(
    seed=3,
    real_time=True,
    runner="thread",
    answer=None,
    choices=("left", "right"),
    attended=False,
    pause_on_failure=True,
    apart=False,
)


def test_how_a_run_was_started_is_read_back(tmp_path):
    OPTIONS.write(tmp_path / "options.json")
    found = KeptOptions.read(tmp_path / "options.json")
    assert (found.seed, found.real_time, found.runner, found.answer) == (3, True, "thread", None)
    assert tuple(found.choices) == ("left", "right")
    assert (found.attended, found.pause_on_failure, found.apart) == (False, True, False)


@pytest.mark.parametrize("text", [None, "{", "[]", "3", '{"seed": 3}', '{"sed": 3}'])
def test_options_that_are_none_are_refused(tmp_path, text):
    path = tmp_path / "options.json"
    if text is not None:
        path.write_text(text)
    with pytest.raises(DataError, match=r"options\.json: how the run was started cannot be read"):
        KeptOptions.read(path)


def test_one_run_writes_into_a_folder_at_a_time(tmp_path):
    held = RunLock(tmp_path)
    told = rf"another run writes into {tmp_path} \(process {os.getpid()}\); wait for its end"
    with pytest.raises(ConfigError, match=told):
        RunLock(tmp_path)
    held.release()
    held.release()  # a second time does nothing
    again = RunLock(tmp_path)
    assert (tmp_path / "lock").read_text() == f"{os.getpid()}\n"
    again.release()


def test_a_shorter_number_leaves_nothing_of_a_longer_one(tmp_path):
    (tmp_path / "lock").write_text("123456789012\n")
    RunLock(tmp_path).release()
    assert (tmp_path / "lock").read_text() == f"{os.getpid()}\n"


def test_a_holder_that_wrote_nothing_is_unknown_and_a_folder_may_be_absent(tmp_path):
    held = RunLock(tmp_path)
    (tmp_path / "lock").write_text("")
    with pytest.raises(ConfigError, match=r"\(process unknown\)"):
        RunLock(tmp_path)
    held.release()
    with pytest.raises(ConfigError, match="cannot be written: No such file"):
        RunLock(tmp_path / "none")


@pytest.mark.parametrize("lacking", ["journal.jsonl", "mission.yaml"])
def test_a_folder_without_a_run_is_not_gone_on_with(tmp_path, lacking):
    for name in {"journal.jsonl", "mission.yaml"} - {lacking}:
        (tmp_path / name).touch()
    told = "holds no run: it lacks journal.jsonl or mission.yaml"
    with pytest.raises(ConfigError, match=told):
        RunFolder.open(tmp_path)
    (tmp_path / lacking).touch()
    folder = RunFolder.open(tmp_path)
    with pytest.raises(ConfigError, match="another run writes into"):
        RunFolder.open(tmp_path)
    folder.release()


def test_a_line_that_was_cut_off_is_left_out_and_told_to_whoever_reads(tmp_path, capsys):
    journal = Journal(tmp_path / "journal.jsonl")
    journal.append(0, 1.0, "main", PauseEnded(1.0))
    journal.append(1, 2.0, "main", PauseEnded(2.0))
    journal.close()
    path = tmp_path / "journal.jsonl"
    with reading(tmp_path) as entries:
        assert [entry.time_s for entry in entries] == [1.0, 2.0]
    assert capsys.readouterr().err == ""
    path.write_bytes(path.read_bytes()[:-10])
    with reading(tmp_path) as entries:
        assert [entry.time_s for entry in entries] == [1.0]
    told = capsys.readouterr().err
    assert told.startswith(f"warning: {path}: the last line is cut off after ")
    path.unlink()
    told = r"holds no run: it has no journal\.jsonl"
    with pytest.raises(ConfigError, match=told), reading(tmp_path):
        pass


def description(settings):
    return SimpleNamespace(plugins={"robot": (SimpleNamespace(name="mine", settings=settings),)})


def test_the_machine_of_a_mission_is_that_of_its_robots_settings():
    assert model_of(description(RobotSettings(model="walker"))) == "walker"
    with pytest.raises(ConfigError, match="the settings of robot plugin 'mine' name no model"):
        model_of(description(NoSettings()))


def test_an_error_of_a_constructor_is_the_robots_and_one_of_ours_stays_as_it_is(monkeypatch):
    def refuse(*given):
        raise ConfigError("no such thing")

    monkeypatch.setattr(selections, "assemble", refuse)
    with pytest.raises(ConfigError, match="no such thing"):
        assembled({}, "m545", 1)

    def fail(*given):
        error = ValueError("too short")
        error.add_note("while the mapping plugin 'odd' was made")
        raise error

    monkeypatch.setattr(selections, "assemble", fail)
    with pytest.raises(RobotError, match="too short") as caught:
        assembled({}, "m545", 1)
    assert "while the mapping plugin 'odd' was made" in str(caught.value)
