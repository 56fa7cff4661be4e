"""`executive journal`: the lines of a run's journal, chosen by kind, node and time."""

import json
from typing import Annotated

import typer

from executive.commands.console import say, terminal_width
from executive.commands.options import JsonOption, RunArgument


def journal(
    run_dir: RunArgument,
    kind: Annotated[
        list[str] | None, typer.Option(help="Only events of this kind; may be repeated.")
    ] = None,
    node: Annotated[
        str | None, typer.Option(help="Only of this node and those below it, such as main/2.")
    ] = None,
    from_: Annotated[
        float | None, typer.Option("--from", help="Only from this mission time on [s].")
    ] = None,
    to: Annotated[
        float | None, typer.Option("--to", help="Only up to this mission time [s].")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Print a run's journal, every line checked.

    The run may still go on. On a terminal, lines are cut to its width; in a pipe or a file they are
    whole. Of a node's path the end is shown; --json has all of it.

    Example: executive journal runs/monday --kind stone_grasped --from 60
    """
    from executive.mission.record.journal_view import line_for_people, plain_entry, reading

    width, count, chosen = terminal_width(), 0, 0
    with reading(run_dir) as entries:
        for entry in entries:
            is_kind = not kind or entry.kind in kind
            is_time = (from_ is None or entry.time_s >= from_) and (
                to is None or entry.time_s <= to
            )
            count += 1
            if is_kind and is_time and (node is None or _is_within(entry.node, node)):
                chosen += 1
                text = json.dumps(plain_entry(entry), ensure_ascii=False) if as_json else None
                print(line_for_people(entry, width) if text is None else text)
    if kind:
        _say_unknown(kind)
    if count and not chosen:
        asked = {"--kind": kind, "--node": node, "--from": from_, "--to": to}
        named = ", ".join(option for option, value in asked.items() if value not in (None, []))
        say(f"warning: none of the {count} entries is chosen by {named}")


def _is_within(path: str, node: str) -> bool:
    """Return whether a path is that of a node or lies below it: main/2 is not main/20."""
    return path.startswith(node) and path[len(node) :][:1] in ("", ":", "/", "@")


def _say_unknown(kinds: list[str]) -> None:
    from executive.errors import did_you_mean
    from executive.events.event import known_kinds

    for kind in kinds:
        if kind not in known_kinds():
            say(f"warning: no event of kind '{kind}'{did_you_mean(kind, known_kinds())}")
