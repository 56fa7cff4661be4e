"""`executive replay`: step through a run, forward and back, with the tree as it was."""

import sys
from typing import TYPE_CHECKING, Annotated

import typer

from executive.commands.console import answer, say, terminal_width
from executive.commands.options import JsonOption, RunArgument

if TYPE_CHECKING:
    from executive.mission.record.journal_view import Moments

_KEYS = "Enter or n: next, b: back, NUMBER: so many events on (or -NUMBER), @TIME: go there, q: end"


def replay(
    run_dir: RunArgument,
    at: Annotated[
        float | None, typer.Option(help="Show the tree at this mission time [s], and end.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Step through a run's events, forward and back.

    Example: executive replay runs/monday --at 83.5
    """
    from executive.mission.record.journal_view import Moments, plain_entry, reading

    with reading(run_dir) as entries:
        moments = Moments(entries)
    if at is None and not as_json:
        _walk(moments)
        return
    moments.go_to(float("inf") if at is None else at)
    moment = moments.moment()
    if as_json:
        entry = plain_entry(moment.entry) if moment.entry else None
        answer({"event": entry, "nodes": {n: list(s) for n, s in moment.states.items()}})
    else:
        print("\n".join(moment.lines(terminal_width())))


def _walk(moments: "Moments") -> None:
    say(_KEYS)
    width = terminal_width()
    while True:
        print("\n".join([f"[{moments.at} of {len(moments)}]", *moments.moment().lines(width)]))
        sys.stdout.flush()
        line = sys.stdin.readline()
        word = line.strip().lower()
        if not line or word == "q":
            return
        if word.startswith("@") and _is_number(word[1:]):
            moments.go_to(float(word[1:]))
        elif word in ("", "n", "b"):
            moments.step(-1 if word == "b" else 1)
        elif word.removeprefix("-").isdecimal():
            moments.step(int(word))
        else:
            say(_KEYS)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
