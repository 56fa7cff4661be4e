"""`executive plugins show`: one plugin."""

import inspect
from typing import Annotated, Any

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
    described = _described(capability, name)
    if as_json:
        answer(described)
        return
    print(f"{capability} {name} ({described['target']}, from {described['distribution']})")
    print(f"  {described['summary']}")
    print(f"  needs: {', '.join(described['needs']) or 'nothing'}")
    for setting in described["settings"]:
        print(f"  {setting['name']:24} {setting['default']!s:16} {setting['description']}")


def _described(capability: str, name: str) -> dict[str, Any]:
    """Return the description of one plugin; imports it."""
    from executive import registry
    from executive.errors import ConfigError, did_you_mean

    if not registry.names(capability):
        known = did_you_mean(capability, registry.capabilities())
        raise ConfigError(f"no plugin of a capability '{capability}'{known}")
    plugin = registry.load(capability, name)
    brought = next(one for one in registry.installed(capability) if one.name == name)
    return {
        "capability": capability,
        "name": name,
        "target": brought.target,
        "distribution": brought.distribution,
        "summary": (inspect.getdoc(plugin) or "").partition("\n")[0],
        "needs": list(registry.dependencies_of(plugin)),
        "settings": [
            {"name": key, "default": _default(field), "description": field.description or ""}
            for key, field in plugin.Settings.model_fields.items()
        ],
    }


def _default(field: Any) -> Any:
    from executive.config import Settings

    if field.is_required():
        return "(required)"
    default = field.get_default(call_default_factory=True)
    return default.model_dump(mode="json") if isinstance(default, Settings) else str(default)
