"""`executive plugins doctor`: which plugins cannot be imported, and why."""

from collections.abc import Mapping

import typer

from executive.commands.console import answer
from executive.commands.options import JsonOption


def doctor(as_json: JsonOption = False) -> None:
    """Say which plugins are broken, and why.

    Every plugin is imported. Exit status 1 says that one is broken; a plugin whose extra is not
    installed is not broken.

    Example: executive plugins doctor
    """
    from executive.registry import diagnose

    findings = diagnose()
    broken = [one for one in findings if one["problem"] and not one["missing_extra"]]
    if as_json:
        answer(findings)
    else:
        for one in findings:
            print(f"{_state(one):29} {one['capability']:13} {one['name']}")
        for one in findings:
            if one["problem"]:
                print(f"warning: {one['problem']}")
    raise typer.Exit(1 if broken else 0)


def _state(finding: Mapping[str, str]) -> str:
    if finding["missing_extra"]:
        return f"missing extra: {finding['missing_extra']}"
    return "broken" if finding["problem"] else "ok"
