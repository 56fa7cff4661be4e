"""`executive plugins list`: the names of all plugins."""

from typing import TYPE_CHECKING

from executive.commands.console import answer
from executive.commands.options import JsonOption

if TYPE_CHECKING:
    from executive.registry import Installed


def list_plugins(as_json: JsonOption = False) -> None:
    """List all plugins by capability.

    Nothing of them is imported.

    Example: executive plugins list --json
    """
    from executive.registry import capabilities, installed

    table = {capability: installed(capability) for capability in capabilities()}
    if as_json:
        answer({capability: [one.name for one in found] for capability, found in table.items()})
        return
    for capability, found in table.items():
        print(f"{capability:13} {', '.join(map(_shown, found)) or '-'}")


def _shown(one: "Installed") -> str:
    return f"{one.name} (missing extra: {one.missing_extra})" if one.missing_extra else one.name
