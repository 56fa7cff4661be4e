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


SIDES = ("left", "right", "leave it")


@pytest.mark.parametrize(
    ("typed", "choice"),
    [
        ("right\n", "right"),
        ("2\n", "right"),
        ("R\n", "right"),
        ("\n", "left"),
        ("leave it\n", "leave it"),
    ],
)
def test_a_person_chooses_by_word_beginning_or_number(typed, choice, capsys):
    question = Operator(read_line=lambda: typed).ask("where to?", "left", SIDES)
    assert wait_for(question) == choice
    assert "where to? [1 left, 2 right, 3 leave it; Enter for left] " in capsys.readouterr().err


def test_a_beginning_of_two_choices_is_asked_again(capsys):
    lines = iter(["le\n", "7\n", "lea\n"])
    question = Operator(read_line=lambda: next(lines)).ask("where to?", None, SIDES)
    assert wait_for(question) == "leave it"
    assert capsys.readouterr().err.count("where to?") == 3


def test_an_option_for_yes_and_no_answers_no_choice(monkeypatch):
    monkeypatch.setattr("sys.stdin", None)
    question = Operator(preset=True).ask("where to?", "right", SIDES)
    assert (question.answer(), question.source()) == ("right", "default")
    with pytest.raises(ConfigError, match="give a default"):
        Operator(preset=True).ask("where to?", None, SIDES)


def test_a_closed_terminal_chooses_nothing_without_a_default(capsys):
    question = Operator(read_line=lambda: "").ask("where to?", None, SIDES)
    deadline = time.monotonic() + 5
    while question.answer() is None and time.monotonic() < deadline:
        time.sleep(0.01)
    assert (question.answer(), question.source()) == ("", "default")
