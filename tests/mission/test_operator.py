"""Questions are answered by a person, an option or a default, and say by which."""

import time

import pytest

from executive.errors import ConfigError
from executive.mission.operator import Operator


def wait_for(question, limit_s=5.0):
    deadline = time.monotonic() + limit_s
    while question.answer() is None and time.monotonic() < deadline:
        time.sleep(0.01)
    return question.answer()


@pytest.mark.parametrize("preset", [True, False])
def test_an_option_answers_before_anybody(preset):
    question = Operator(preset, read_line=lambda: "no\n").ask("go on?", not preset)
    assert (question.answer(), question.source()) == (preset, "option")


@pytest.mark.parametrize(("typed", "answer"), [("yes\n", True), ("N\n", False), (" y \n", True)])
def test_a_person_answers_on_the_terminal(typed, answer, capsys):
    question = Operator(read_line=lambda: typed).ask("lift?", None)
    assert wait_for(question) is answer
    assert question.source() == "operator"


def test_an_unclear_answer_is_asked_again(capsys):
    lines = iter(["perhaps\n", "\n", "no\n"])
    question = Operator(read_line=lambda: next(lines)).ask("lift?", None)
    assert wait_for(question) is False
    assert capsys.readouterr().err.count("lift? [y/n]") == 3


def test_an_empty_line_takes_the_default(capsys):
    assert wait_for(Operator(read_line=lambda: "\n").ask("lift?", True)) is True
    assert "[Y/n]" in capsys.readouterr().err


def test_a_closed_terminal_takes_the_default(capsys):
    question = Operator(read_line=lambda: "").ask("lift?", True)
    assert wait_for(question) is True
    assert question.source() == "default"


def test_without_a_terminal_the_default_answers(monkeypatch):
    monkeypatch.setattr("sys.stdin", None)
    question = Operator().ask("lift?", False)
    assert (question.answer(), question.source()) == (False, "default")


def test_refuses_when_nobody_can_answer(monkeypatch):
    monkeypatch.setattr("sys.stdin", None)
    with pytest.raises(ConfigError, match=r"--answer yes\|no"):
        Operator().ask("lift?", None)
