"""`executive words`: the list, one word, and what programs get."""

import json
import sys

import pytest

from executive.commands.main import main
from executive.tree.kind_keys import KINDS, MODIFIERS


@pytest.fixture
def words(monkeypatch, capsys):
    def run(*given):
        monkeypatch.setattr(sys, "argv", ["executive", "words", *given])
        status = 0
        try:
            main()
        except SystemExit as end:
            status = int(end.code or 0)
        return status, *capsys.readouterr()

    return run


def test_all_words_are_listed_in_lines_that_fit_a_terminal(words):
    status, output, errors = words()
    assert (status, errors) == (0, "")
    listed = [line.split()[0] for line in output.splitlines() if line.startswith("  ")]
    assert {*KINDS, *MODIFIERS, "ScanSwing", "NoStoneLeft"} <= set(listed)
    assert max(map(len, output.splitlines())) <= 105


def test_one_word_shows_ports_units_claims_and_an_example(words):
    status, output, _ = words("CloseGripper")
    assert status == 0
    for shown in (
        "CloseGripper: action, from executive",
        "drives: jaws, arm, cabin",
        "needs plugins for: robot, motion, objects",
        "in   stone: int",
        "out  hold: Hold",
        "with force: force [N], may be left out (> 0)",
        "with removal_radius: length [m], default 1.0 (> 0, ≤ 3)",
        'in: {stone: "{stone}"}',
    ):
        assert shown in output


def test_a_node_shows_how_it_is_written(words):
    assert "written as: loop: {until: condition, max: 20}, do: node" in words("loop")[1]


def test_programs_get_the_same_as_json(words):
    every = json.loads(words("--json")[1])
    one = json.loads(words("ScanSwing", "--json")[1])
    assert one in every
    assert [setting["unit"] for setting in one["settings"]] == ["rad", "s"]
    assert one["example"].startswith("run: ScanSwing")


def test_an_unknown_word_is_refused(words):
    assert words("ScanSwng") == (2, "", "error: no word 'ScanSwng'. Did you mean 'ScanSwing'?\n")
