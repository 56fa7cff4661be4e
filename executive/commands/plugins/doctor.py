"""`executive plugins doctor`: which plugins cannot be imported, and why."""

import typer

from executive.commands.console import answer
from executive.commands.options import JsonOption


def doctor(as_json: JsonOption = False) -> None:
    """Say which plugins are broken, and why.

    Every plugin is imported. Exit status 1 says that one is broken.

    Example: executive plugins doctor
    """
    from executive.registry import diagnose

    findings = diagnose()
    broken = [finding for finding in findings if finding["problem"]]
    if as_json:
        answer(findings)
    else:
        for finding in findings:
            state = "broken" if finding["problem"] else "ok"
            print(f"{state:7} {finding['capability']:13} {finding['name']}")
        for finding in broken:
            print(f"warning: {finding['problem']}")
    raise typer.Exit(1 if broken else 0)
