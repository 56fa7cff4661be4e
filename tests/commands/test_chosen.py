"""A plugin of a single command is started before it is given, and closed whatever happens."""

from types import SimpleNamespace

import pytest

from executive.commands import chosen as module
from executive.commands.chosen import chosen
from executive.errors import ConfigError
from executive.interfaces.segmentation import Segmenter
from executive.tree.choices import Choices


@pytest.fixture
def told(monkeypatch):
    """Return what the assembly is told, in its order."""
    words = []
    assembly = SimpleNamespace(
        plugins={"segmentation": "the segmenter"},
        start=lambda: words.append("start"),
        close=lambda: words.append("close"),
    )

    def assemble(selections, model, seed):
        words.append(("assemble", sorted(selections), model, seed))
        return assembly

    monkeypatch.setattr(module, "assemble", assemble)
    return words


def test_a_plugin_is_started_before_it_is_given_and_closed_after(told):
    with chosen(Segmenter, model="mini") as given:
        assert given == "the segmenter"
        assert told == [("assemble", ["segmentation"], "mini", 0), "start"]
    assert told[1:] == ["start", "close"]


def test_the_machine_is_the_one_of_the_choices_unless_a_command_names_another(told):
    choices = Choices(("segmentation",))
    with chosen(Segmenter, choices):
        assert told[0][2] == choices.model


def test_a_plugin_is_closed_when_the_command_fails(told):
    with pytest.raises(ConfigError), chosen(Segmenter):
        raise ConfigError("no")
    assert told[1:] == ["start", "close"]
