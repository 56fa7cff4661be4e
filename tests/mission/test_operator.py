"""Questions are answered by a person, an option or a default, and say by which."""

import re
import time

import pytest

from executive.errors import ConfigError
from executive.mission.operator import Operator
from executive.mission.preset_answers import PresetAnswers, preset_answers
from executive.tree.load import load_mission


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
    with pytest.raises(ConfigError, match=r"give --answer left\|right\|leave it or a default"):
        Operator(preset=True).ask("where to?", None, SIDES)


def test_a_closed_terminal_chooses_nothing_without_a_default(capsys):
    question = Operator(read_line=lambda: "").ask("where to?", None, SIDES)
    deadline = time.monotonic() + 5
    while question.answer() is None and time.monotonic() < deadline:
        time.sleep(0.01)
    assert (question.answer(), question.source()) == ("", "default")


def test_a_choice_given_beforehand_answers_the_questions_that_offer_it(monkeypatch):
    monkeypatch.setattr("sys.stdin", None)
    operator = Operator(chosen=("left", "leave"))
    asked = [
        operator.ask("?", None, choices) for choices in (["grasp", "leave"], ["left", "leave"])
    ]
    assert [(one.answer(), one.source()) for one in asked] == [
        ("leave", "option"),
        ("left", "option"),
    ]
    with pytest.raises(ConfigError, match=r"give --answer a\|b or a default"):
        operator.ask("?", None, ["a", "b"])
    with pytest.raises(ConfigError, match=r"give --answer yes\|no or a default"):
        operator.ask("?", None)


@pytest.fixture
def mission(tmp_path):
    path = tmp_path / "asks.yaml"
    path.write_text(
        "api: 1\nmission: asks\nplugins: {robot: kinematic, estimation: gnss_imu_filter}\n"
        "trees: {main: {sequence: [{ask: Go on?}, {ask: Which?, choices: [left, right]}]}}\n"
    )
    return load_mission(str(path))


@pytest.mark.parametrize(
    ("given", "preset"),
    [
        ([], PresetAnswers()),
        (["no"], PresetAnswers(answer=False)),
        (["right", "yes", "left"], PresetAnswers(True, ("right", "left"))),
    ],
)
def test_answers_are_sorted_by_the_questions_that_take_them(mission, given, preset):
    assert preset_answers(given, mission) == preset


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (["rigth"], "no question of asks takes 'rigth'. Did you mean 'right'?"),
        (["yes", "no"], "yes and no are both given"),
    ],
)
def test_answers_that_no_question_takes_are_refused(mission, given, told):
    with pytest.raises(ConfigError, match=re.escape(told)):
        preset_answers(given, mission)
