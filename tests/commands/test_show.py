"""`plugins show` tells what a plugin is, what it needs, and each of its settings."""

import json

import pytest
from pydantic import Field

from executive import registry
from executive.commands.plugins.show import _default
from executive.config import Settings
from tests.commands.in_process import executive


def test_a_plugin_is_shown_with_its_source_its_needs_and_its_settings(monkeypatch, capsys):
    assert executive(monkeypatch, "plugins", "show", "alignment", "gicp") == 0
    first, summary, needs, *settings = capsys.readouterr().out.splitlines()
    plugin = registry.load("alignment", "gicp")
    assert first.startswith("alignment gicp (executive_plugins.alignment.")
    assert first.endswith(")")
    assert ", from " in first
    assert summary == f"  {plugin.__doc__.strip().splitlines()[0]}"
    assert needs == "  needs: nothing"
    fields = plugin.Settings.model_fields
    assert [line.split()[0] for line in settings] == list(fields)
    for line, (name, field) in zip(settings, fields.items(), strict=True):
        assert line == f"  {name:24} {field.default!s:16} {field.description}"


def test_what_a_plugin_needs_is_told(monkeypatch, capsys):
    plugin = registry.load("grasping", "sampled_antipodal")
    assert executive(monkeypatch, "plugins", "show", "grasping", "sampled_antipodal") == 0
    needs = ", ".join(registry.dependencies_of(plugin))
    assert needs
    assert f"  needs: {needs}\n" in capsys.readouterr().out


def test_as_json_the_same_is_told(monkeypatch, capsys):
    assert executive(monkeypatch, "plugins", "show", "grasping", "sampled_antipodal", "--json") == 0
    shown = json.loads(capsys.readouterr().out)
    plugin = registry.load("grasping", "sampled_antipodal")
    assert (shown["capability"], shown["name"]) == ("grasping", "sampled_antipodal")
    assert shown["needs"] == list(registry.dependencies_of(plugin))
    assert [one["name"] for one in shown["settings"]] == list(plugin.Settings.model_fields)


class Inner(Settings):
    length_m: float = Field(2.0, description="Length [m].")


class Outer(Settings):
    inner: Inner = Field(default_factory=Inner, description="What is inside.")
    name: str = Field(description="Its name.")
    count: int = Field(3, description="How many.")


def test_a_default_is_a_text_the_values_of_a_group_or_said_to_be_required():
    defaults = {name: _default(field) for name, field in Outer.model_fields.items()}
    assert defaults == {"inner": {"length_m": 2.0}, "name": "(required)", "count": "3"}


@pytest.mark.parametrize("words", [("alignment", "gicpp"), ("alignmnt", "gicp")])
def test_a_plugin_that_there_is_not_is_refused_with_the_nearest_word(monkeypatch, capsys, words):
    assert executive(monkeypatch, "plugins", "show", *words) == 2
    right = {"gicpp": "gicp", "gicp": "alignment"}[words[1]]
    assert f"Did you mean '{right}'" in capsys.readouterr().err
