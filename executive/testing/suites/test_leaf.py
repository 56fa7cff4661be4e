"""What every leaf must be: typed, described, made without a robot, and drawn from its class."""

import inspect
import json

import pytest
from pydantic import ValidationError

from executive import registry
from executive.config import Settings
from executive.interfaces.plugin import Plugin
from executive.leaf.action import Action, Condition, Leaf
from executive.testing.suites.test_settings import fields_of, is_bounded, is_number


def test_it_is_an_action_or_a_condition(leaf: type[Leaf[Settings]]) -> None:
    kinds = [kind for kind in (Action, Condition) if issubclass(leaf, kind)]
    assert len(kinds) == 1, "it must derive from either Action or Condition"


def test_it_implements_its_verb(leaf: type[Leaf[Settings]]) -> None:
    missing = sorted(getattr(leaf, "__abstractmethods__", ()))
    assert not missing, f"not implemented: {', '.join(missing)}"


def test_it_says_what_it_does(leaf: type[Leaf[Settings]]) -> None:
    assert (leaf.__doc__ or "").strip(), "the class has no docstring; `executive words` prints it"


def test_each_port_is_described(leaf: type[Leaf[Settings]]) -> None:
    ports = {**leaf.inputs, **leaf.outputs}
    missing = [name for name, port in ports.items() if not port.doc]
    assert not missing, f"no description: {', '.join(missing)}; name them under Args or Attributes"


def test_it_needs_interfaces_that_are_installed(leaf: type[Leaf[Settings]]) -> None:
    for interface in leaf.needs:
        assert issubclass(interface, Plugin), f"needs names {interface}, which is no interface"
        assert interface.capability in registry.capabilities(), (
            f"no capability '{interface.capability}' is installed"
        )


def examples_of(settings: type[Settings]) -> dict[str, object]:
    """Return the first example of each field that is a value, not an expression over keys."""
    values = {
        name: [one for one in field.examples or () if not (isinstance(one, str) and "{" in one)]
        for name, field in settings.model_fields.items()
    }
    return {name: found[0] for name, found in values.items() if found}


def test_it_is_made_without_a_mission(leaf: type[Leaf[Settings]]) -> None:
    class Untouched:
        def __getattr__(self, name: str) -> object:
            raise AssertionError(f"the constructor calls context.{name}: it may only store it")

    examples = examples_of(leaf.Settings)
    fields = leaf.Settings.model_fields.items()
    missing = [name for name, field in fields if field.is_required() and name not in examples]
    if missing:
        pytest.skip(f"its settings have neither default nor example: {', '.join(missing)}")
    leaf(leaf.Settings.model_validate(examples), Untouched())  # type: ignore[arg-type]


def test_an_action_waits_in_a_generator(leaf: type[Leaf[Settings]]) -> None:
    if issubclass(leaf, Action):
        assert inspect.isgeneratorfunction(leaf.run), "run must yield where it waits"


def test_its_settings_are_described_bounded_and_closed(leaf: type[Leaf[Settings]]) -> None:
    assert issubclass(leaf.Settings, Settings), "Settings must derive from executive.config"
    for path, field in fields_of(leaf.Settings):
        assert (field.description or "").strip(), f"no description: {path}"
        assert not is_number(field.annotation) or is_bounded(field), f"no bound: {path}"
    json.dumps(leaf.Settings.model_json_schema())
    with pytest.raises(ValidationError):
        leaf.Settings.model_validate({"no_such_setting": 1})
