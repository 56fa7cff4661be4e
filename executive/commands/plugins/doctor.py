"""`executive plugins doctor`: which plugins cannot be imported, and why."""

from collections.abc import Mapping

import typer

from executive import registry
from executive.commands.console import answer
from executive.commands.options import JsonOption
from executive.extras import MissingExtraError

# All groups whose entries are imported; settings and extras are read with their plugins.
_GROUPS = (
    registry.SMOOTHERS,
    registry.CALIBRATORS,
    registry.BEHAVIOURS,
    registry.ORACLES,
    registry.EXERCISES,
    registry.WORKS,
    registry.METRICS,
    registry.VERBS,
)


def doctor(as_json: JsonOption = False) -> None:
    """Say which plugins are broken, and why.

    Every plugin is imported. Exit status 1 says that one is broken; a plugin whose extra is not
    installed is not broken.

    Example: executive plugins doctor
    """
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


def diagnose() -> list[dict[str, str]]:
    """Import every installed plugin, behaviour and verb, and return which are broken, and why."""
    groups = (registry.INTERFACES, *registry.capabilities(), *_GROUPS)
    return [
        {
            "capability": group,
            "name": one.name,
            "target": one.target,
            "problem": _problem(group, one.name),
            "missing_extra": one.missing_extra,
        }
        for group in groups
        for one in registry.installed(group)
    ]


def _problem(group: str, name: str) -> str:
    """Return why one of a group cannot be imported, or an empty text."""
    loads = {registry.VERBS: registry.load_verb, registry.INTERFACES: registry.interface}
    try:
        if group in loads:
            loads[group](name)
        else:
            registry.load(group, name)
        registry.require_extras(group, name)
    except (registry.BrokenPluginError, MissingExtraError) as error:
        return str(error)
    return ""


def _state(finding: Mapping[str, str]) -> str:
    if finding["missing_extra"]:
        return f"missing extra: {finding['missing_extra']}"
    return "broken" if finding["problem"] else "ok"
