"""The live display on a terminal leaves a question as it is written."""

import io
import sys
import types

import pytest
from rich.console import Console

from executive.mission.operator import Operator
from executive.mission.phase import Phase
from executive.mission.progress import LiveProgress


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
