"""Verbs of the command line by name: each is imported when it is asked for."""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any, ClassVar

import typer
from typer.core import TyperGroup

from executive.errors import did_you_mean


class Verbs(TyperGroup):
    """A group of verbs; subclasses say which.

    A verb costs its import and the reading of its options, so that one command pays for itself
    alone; only `--help` lists them all.

    Attributes:
        functions: `module:function` by the verb's name, below `executive.commands`.
    """

    functions: ClassVar[Mapping[str, str]] = {}

    def list_commands(self, ctx: Any) -> list[str]:
        return [*self.functions, *super().list_commands(ctx)]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        if cmd_name not in self.functions:
            return super().get_command(ctx, cmd_name)
        module, _, function = self.functions[cmd_name].partition(":")
        found = getattr(import_module(f"executive.commands.{module}"), function)
        return command_of(cmd_name, found)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        known = self.list_commands(ctx)
        if args[0] not in known and not args[0].startswith("-"):
            ctx.fail(f"no command '{args[0]}'{did_you_mean(args[0], known)}")
        return super().resolve_command(ctx, args)


def command_of(name: str, function: Callable[..., None]) -> Any:
    """Return the command that a function with typer's annotations describes."""
    alone = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
    alone.command(name)(function)
    return typer.main.get_command(alone)
