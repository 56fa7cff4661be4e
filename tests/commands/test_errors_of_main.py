"""What the command line makes of an error, of a reader that is gone, and of `--version`."""

import os
import sys
from importlib import metadata
from types import SimpleNamespace

import pytest

from executive.commands import main
from executive.commands.console import answer
from executive.errors import ConfigError, DataError, RobotError
from tests.commands.in_process import executive


@pytest.fixture
def ends(monkeypatch, capsys):
    """Return what lets a verb raise an error: exit status and what is said."""

    def end(error):
        def app():
            raise error

        monkeypatch.setattr(main, "app", app)
        monkeypatch.setattr(main, "_drop_output", lambda: None)
        status = executive(monkeypatch, "check")
        return status, capsys.readouterr().err

    return end


@pytest.mark.parametrize(
    ("error", "status", "told"),
    [
        (RobotError("the boom is stuck"), 3, "fault: the boom is stuck\n"),
        (ConfigError("no such plugin"), 2, "error: no such plugin\n"),
        (DataError("cut off"), 2, "error: cut off\n"),
        (ConfigError("a.yaml:2:1: error: no key"), 2, "a.yaml:2:1: error: no key\n"),
        (BrokenPipeError(32, "Broken pipe"), 1, ""),
        (OSError(28, "No space left on device"), 2, "error: No space left on device\n"),
        (
            FileNotFoundError(2, "No such file", "map.ply"),
            2,
            "error: map.ply: No such file\n",
        ),
        (OSError("odd"), 2, "error: odd\n"),
    ],
)
def test_an_error_has_its_status_and_one_line(ends, error, status, told):
    assert ends(error) == (status, told)


def test_another_error_keeps_its_traceback(ends):
    with pytest.raises(ZeroDivisionError):
        ends(ZeroDivisionError())


def test_an_answer_that_cannot_be_flushed_is_an_error(monkeypatch, capsys):
    def flush():
        raise OSError(28, "No space left on device")

    dropped = []
    monkeypatch.setattr(main, "app", lambda: None)
    monkeypatch.setattr(main, "_drop_output", lambda: dropped.append(1))
    monkeypatch.setattr(sys, "stdout", SimpleNamespace(flush=flush))
    assert executive(monkeypatch, "check") == 2
    assert capsys.readouterr().err == "error: No space left on device\n"
    assert dropped == [1]


def test_what_nobody_reads_any_more_goes_nowhere(monkeypatch, tmp_path):
    with (tmp_path / "answer").open("w") as file:
        monkeypatch.setattr(sys, "stdout", file)
        main._drop_output()
        assert os.path.samestat(os.fstat(file.fileno()), os.stat(os.devnull))
        file.write("more")
    assert (tmp_path / "answer").read_text() == ""


def test_an_output_that_is_no_file_is_left_alone(monkeypatch):
    monkeypatch.setattr(sys, "stdout", SimpleNamespace(fileno=lambda: -1))
    main._drop_output()


def test_the_version_is_printed(monkeypatch, capsys):
    assert executive(monkeypatch, "--version") == 0
    assert capsys.readouterr().out == f"executive {metadata.version('executive')}\n"


def test_a_verb_of_a_plugin_is_listed_and_found(monkeypatch, capsys):
    def greet():
        """Greet whoever asks.

        Example: executive greet
        """
        print("good day")

    monkeypatch.setattr(main, "names", lambda group: ["greet"])
    monkeypatch.setattr(main, "load_verb", lambda name: {"greet": greet}[name])
    assert executive(monkeypatch, "greet") == 0
    assert capsys.readouterr().out == "good day\n"
    assert executive(monkeypatch, "--help") == 0
    told = capsys.readouterr().out
    assert "greet" in told
    assert "compare-estimators" in told
    assert executive(monkeypatch, "gret") == 2


def test_answers_hold_letters_of_any_language_as_they_are(capsys):
    answer({"site": "Hügel", "count": 2})
    assert capsys.readouterr().out == '{\n  "site": "Hügel",\n  "count": 2\n}\n'
