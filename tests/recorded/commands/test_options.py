"""Options and arguments of each command: names, defaults and bounds."""

import importlib
import inspect
import typing
from collections.abc import Callable, Iterator

from typer.models import ParameterInfo

import executive.commands.main  # noqa: F401 - defines the groups of commands
from executive.commands.verbs import Verbs


def commands() -> Iterator[tuple[str, Callable[..., object]]]:
    """Yield each command by its words."""
    for group in Verbs.__subclasses__():
        for name, place in group.functions.items():
            module, _, function = place.partition(":")
            found = getattr(importlib.import_module(f"executive.commands.{module}"), function)
            yield f"plugins {name}" if module.startswith("plugins.") else name, found


def described(command: Callable[..., object]) -> dict[str, list[object]]:
    """Return what a user can give a command, without the texts that explain it."""
    hints = typing.get_type_hints(command, include_extras=True)
    told: dict[str, list[object]] = {}
    for name, parameter in inspect.signature(command).parameters.items():
        marks = getattr(hints[name], "__metadata__", ())
        info = next((one for one in marks if isinstance(one, ParameterInfo)), None)
        default = "to be given"
        if parameter.default is not inspect.Parameter.empty:
            default = repr(parameter.default)
        words = [info.default, *(info.param_decls or ())] if info else []
        bounds = [info.min, info.max] if info else []
        told[name] = [[one for one in words if isinstance(one, str)], default, bounds]
    return told


def test_options(recorded) -> None:
    recorded({words: described(one) for words, one in commands()})
