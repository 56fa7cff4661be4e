"""What `--help` says of a verb is true of that verb."""

import re

import pytest
import typer

from executive.commands.main import app

GROUP = typer.main.get_command(app)
VERBS = GROUP.list_commands(typer.Context(GROUP))


@pytest.mark.parametrize("name", VERBS)
def test_an_option_names_only_options_that_the_verb_has(name: str) -> None:
    verb = GROUP.get_command(typer.Context(GROUP), name)
    own = {option for param in verb.params for option in param.opts}
    said = " ".join(getattr(param, "help", None) or "" for param in verb.params)
    assert set(re.findall(r"--[a-z][a-z-]*", said)) <= own
