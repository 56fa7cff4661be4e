"""What is shown of a mission: the tree on a terminal, one line an event elsewhere, or nothing."""

import io
import sys
import types

import numpy as np
import pytest
from rich.console import Console

from executive.events.mission import PauseEnded
from executive.events.site import Localised, SlotsFound
from executive.journal import Journal
from executive.mission import progress as progress_module
from executive.mission.operator import Operator
from executive.mission.phase import Phase
from executive.mission.progress import LiveProgress, PlainProgress, Silence, Tolerant, progress
from executive.tree.build import NodeState


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize(
    ("default", "hint"), [(False, "[y/N]"), (True, "[Y/n]"), (None, "[y/n]"), ("a", "[1 a, 2 b")]
)
def test_a_question_is_shown_with_its_answers(monkeypatch, default, hint):
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    choices = ("a", "b") if default == "a" else ()
    with LiveProgress():
        assert sys.stderr is not terminal  # rich has put its own in place
        question = Operator(read_line=lambda: "y\n" if default != "a" else "a\n").ask(
            "Lift [bold] stone 3?", default, choices
        )
        while question.answer() is None:
            pass
    assert f"Lift [bold] stone 3? {hint}" in terminal.getvalue()


def test_nothing_is_drawn_over_what_the_operator_types(monkeypatch):
    progress = LiveProgress()
    progress._console = Console(file=io.StringIO())
    drawn = []
    monkeypatch.setattr(progress, "_picture", lambda mission, now_s: drawn.append(now_s) or "")
    for phase in (Phase.AWAITING_OPERATOR, Phase.AWAITING_OPERATOR, Phase.AWAITING_OPERATOR):
        progress(types.SimpleNamespace(phase=phase))
    assert len(drawn) == 1


def mission(*, phase=Phase.RUNNING, placed=0, stones=0, time_s=12.5):
    return types.SimpleNamespace(
        phase=phase,
        clock=types.SimpleNamespace(now_s=lambda: time_s),
        account=types.SimpleNamespace(placed=placed, stones_found=stones),
        root=None,
    )


def row(name, depth=0, status="RUNNING", feedback="", *, is_worth_showing=True):
    return NodeState(f"main/{name}", name, depth, status, feedback, is_worth_showing)


@pytest.fixture
def display(monkeypatch):
    """A live display whose wall clock and tree are set, without a terminal.

    What it draws is kept in `pictures`.
    """
    display = types.SimpleNamespace(wall_s=100.0, rows=[], pictures=[])
    monkeypatch.setattr(progress_module, "wall_s", lambda: display.wall_s)
    monkeypatch.setattr(progress_module, "node_states", lambda root: display.rows)
    live = LiveProgress()
    live._console = Console(file=io.StringIO(), height=10)
    live._live = types.SimpleNamespace(
        update=lambda picture, refresh: display.pictures.append((picture.plain, refresh))
    )
    display.show = live
    return display


def test_the_tree_is_drawn_with_each_nodes_state_and_words(display):
    display.rows = [
        row("main"),
        row("scan", 1, "SUCCESS", "done"),
        row("calm", 1, "FAILURE", "wind"),
        row("above", 2, "INVALID"),
        row("hidden", 2, is_worth_showing=False),
        row("drive", 1, "SKIPPED", "not far"),
    ]
    display.wall_s += 5.0
    display.show(mission(placed=2, stones=7))
    assert display.pictures == [
        (
            "running     12.5 s  2.5× real time  stone 2 of 7\n"
            "▶ main\n  ✓ scan  done\n  ✗ calm  wind\n    · above\n  – drive  not far\n",
            True,
        )
    ]


def test_before_stones_are_found_and_time_has_passed_the_head_is_short(display):
    display.show(mission(phase=Phase.AWAITING_OPERATOR, time_s=0.0))
    assert display.pictures == [("awaiting_operator      0.0 s  0.0× real time\n", True)]


def test_a_tree_is_cut_to_the_height_of_the_terminal(display):
    display.rows = [row(f"n{number}") for number in range(20)]
    display.wall_s += 1.0
    display.show(mission())
    assert len(display.pictures[0][0].splitlines()) == 1 + 7  # of 10 lines, three are left free
    display.show._console = Console(file=io.StringIO(), height=4)
    display.wall_s += 1.0
    display.show(mission())
    assert len(display.pictures[1][0].splitlines()) == 1 + 5


def test_the_tree_is_drawn_four_times_a_second_at_most_and_when_a_question_begins(display):
    drawn = []
    for passed_s, phase in [
        (0.125, Phase.RUNNING), (0.125, Phase.RUNNING), (0.125, Phase.RUNNING),
        (0.0, Phase.AWAITING_OPERATOR), (1.0, Phase.AWAITING_OPERATOR), (0.125, Phase.RUNNING),
        (0.0, Phase.AWAITING_OPERATOR),
    ]:  # fmt: skip
        display.wall_s += passed_s
        display.show(mission(phase=phase))
        drawn.append(len(display.pictures))
    assert drawn == [0, 1, 1, 2, 2, 3, 4]


def test_each_event_that_is_worth_a_line_is_written_once_with_its_time(capsys):
    journal = Journal()
    shown = types.SimpleNamespace(journal=journal)
    journal.append(1, 0.05, "main", PauseEnded(1.0))  # worth no line
    journal.append(4, 12.345, "main", Localised(np.eye(4), "GLOBAL"))
    with PlainProgress() as plain:
        plain(shown)
        plain(shown)
        journal.append(5, 1234.5, "main", SlotsFound([]))
        plain(shown)
    assert capsys.readouterr().err.splitlines() == [
        "   12.35 s  localised (GLOBAL)",
        " 1234.50 s  0 free places",
    ]


@pytest.mark.parametrize(
    ("quiet", "is_terminal", "kind"),
    [(True, True, None), (False, True, LiveProgress), (False, False, PlainProgress)],
)
def test_the_progress_suits_standard_error(monkeypatch, quiet, is_terminal, kind):
    monkeypatch.setattr(sys, "stderr", Terminal() if is_terminal else io.StringIO())
    found = progress(quiet=quiet)
    if kind is None:
        assert isinstance(found, Silence)
        with found as silence:
            assert silence("a mission") is None
    else:
        assert type(found._shown) is kind


@pytest.mark.parametrize("fails", ["while shown", "at the end", "never"])
def test_a_progress_that_nobody_reads_falls_silent_and_the_mission_goes_on(monkeypatch, fails):
    told, dropped = [], []

    class Shown:
        def __call__(self, mission):
            told.append(mission)
            if fails == "while shown":
                raise BrokenPipeError

        def __enter__(self):
            told.append("begins")

        def __exit__(self, *error):
            told.append("ends")
            if fails == "at the end":
                raise BrokenPipeError

    monkeypatch.setattr(progress_module, "drop_errors", lambda: dropped.append(1))
    with Tolerant(Shown()) as tolerant:
        tolerant("first")
        tolerant("second")
    rest = {"while shown": [], "at the end": ["second", "ends"], "never": ["second", "ends"]}
    assert told == ["begins", "first", *rest[fails]]
    assert dropped == ([] if fails == "never" else [1])
