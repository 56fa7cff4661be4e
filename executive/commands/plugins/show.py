"""`executive plugins show`: one plugin."""

from typing import Annotated

import typer

from executive.commands.console import answer
from executive.commands.options import JsonOption


def show_plugin(
    capability: Annotated[str, typer.Argument(help="Its capability, such as registration.")],
    name: Annotated[str, typer.Argument(help="Its name, as `plugins list` prints it.")],
    as_json: JsonOption = False,
) -> None:
    """Show one plugin and its settings.

    Example: executive plugins show registration segment_shot
    """
    from executive.registry import describe

    described = describe(capability, name)
    if as_json:
        answer(described)
        return
    print(f"{capability} {name} ({described['target']}, from {described['distribution']})")
    print(f"  {described['summary']}")
    print(f"  needs: {', '.join(described['needs']) or 'nothing'}")
    for setting in described["settings"]:
        print(f"  {setting['name']:24} {setting['default']!s:16} {setting['description']}")
