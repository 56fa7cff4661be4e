"""`executive ctl`: control a mission that runs, from another terminal."""

from typing import Annotated, Any

import typer

from executive.commands.console import answer, one_of, say
from executive.commands.options import JsonOption, RunArgument

_LONGEST_S = 3600.0
_WAIT_S = 60.0  # in lock-step a tick may compute a long verb


def ctl(
    run_dir: RunArgument,
    verb: Annotated[
        str,
        typer.Argument(
            metavar="VERB",
            help="pause, resume, stop, step, skip, retry, answer, reset or status.",
            show_default=False,
        ),
    ],
    argument: Annotated[
        str,
        typer.Argument(
            metavar="[WORD]",
            help="The answer of `answer`; the number of ticks of `step`.",
            show_default=False,
        ),
    ] = "",
    node: Annotated[
        str, typer.Option(help="Path of the node to skip, retry or answer, if several can be.")
    ] = "",
    on_failure: Annotated[
        bool,
        typer.Option(
            "--on-failure",
            help="With pause: whenever an action fails from now on. With resume: no longer.",
        ),
    ] = False,
    timeout: Annotated[float, typer.Option(help="How long to wait for the reply [s].")] = _WAIT_S,
    as_json: JsonOption = False,
) -> None:
    """Control a mission that runs.

    The run listens in its folder for its own user. Who asked for what is in its journal. Exit
    status 1: the mission refused, and says why.

    Example: executive ctl runs/monday pause
    """
    from executive.control.client import ask
    from executive.control.request import Request, Verb
    from executive.errors import ConfigError

    wanted = Verb(one_of("VERB", verb, list(Verb)))
    _check(wanted, argument, on_failure=on_failure)
    if not 0 < timeout <= _LONGEST_S:  # so that `nan` is refused as well
        raise ConfigError(f"--timeout: more than 0 s and at most {_LONGEST_S:g}, got {timeout:g}")
    request = Request(wanted, "on_failure" if on_failure else argument, node)
    reply = ask(run_dir, request, timeout)
    if as_json:
        answer(
            reply.status
            if wanted is Verb.STATUS
            else {"is_done": reply.is_done, "text": reply.text}
        )
    elif reply.status:
        print("\n".join(_lines(reply.status)))
    else:
        say(reply.text if reply.is_done else f"refused: {reply.text}")
    raise typer.Exit(0 if reply.is_done else 1)


def _check(verb: str, argument: str, *, on_failure: bool) -> None:
    """Refuse what a verb does not take.

    Raises:
        ConfigError: With the cure.
    """
    from executive.errors import ConfigError

    if argument and verb not in ("answer", "step"):
        raise ConfigError(f"ctl {verb} takes no word, got '{argument}'")
    if verb == "answer" and not argument:
        raise ConfigError("ctl answer: give the answer, such as yes, no or one of the choices")
    if on_failure and verb not in ("pause", "resume"):
        raise ConfigError("--on-failure belongs to pause and resume")


def _lines(status: Any) -> list[str]:
    """Return how a mission is, for people."""
    reason = f": {status['reason']}" if status["reason"] else ""
    lines = [f"{status['phase']}{reason}", f"  mission time  {status['mission_s']:.2f} s"]
    for one in status["running"]:
        lines.append(f"  runs          {one['node']}" + (f"  {one['says']}" if one["says"] else ""))
    for one in status["failed"]:
        lines.append(f"  failed        {one['node']}: {one['reason']} (skip, retry or resume)")
    for one in status["questions"]:
        lines.append(f"  asks          {one['text']} [{', '.join(one['answers'])}]  {one['node']}")
    if status["latched"]:
        lines.append(f"  latched       {status['latched']} (reset)")
    return lines
