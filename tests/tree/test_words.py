"""The description of every word: complete, and with an example that the reader takes."""

from pathlib import Path

import numpy as np
import pytest
from pydantic import Field

from executive.config import Radians, Settings
from executive.errors import ConfigError
from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.outcome import succeeded
from executive.messages.region import Region
from executive.tree.catalogue import InstalledCatalogue
from executive.tree.document import read_file
from executive.tree.kind_keys import KINDS, MODIFIERS
from executive.tree.node_reader import NodeReader
from executive.tree.problem import Problems
from executive.tree.reading import Reading
from executive.tree.words.leaf_word import leaf_word
from executive.tree.words.vocabulary import Vocabulary, vocabulary

ALL = vocabulary()
REGIONS = {"corridor": Region("corridor", np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]))}
TREES = {"relocate_one": ({"stone": "int", "free_slots": "list[Slot]"}, {})}


class TiltSettings(Settings):
    angle: Radians = Field(0.5, gt=0, le=1, description="By how much [rad].")
    side: str | None = Field(None, examples=["left"], description="To which side.")
    quietly: bool = Field(description="Whether without a sound.", examples=[True])


class Tilt(Action[TiltSettings]):
    """Tilt the cabin. This is the summary.

    And this is not.
    """

    claims = (Part.CABIN,)

    def run(self, by: str, more: int | None = None) -> Steps[None]:
        """Tilt.

        Args:
            by: Who.
            more: How much more.
        """
        return succeeded()


def test_every_kind_every_modifier_and_every_leaf_is_a_word() -> None:
    assert not ALL.broken
    assert set(ALL.words) == {*KINDS, *MODIFIERS, *InstalledCatalogue().behaviour_names()}


@pytest.mark.parametrize("name", sorted(ALL.words))
def test_a_word_says_what_it_does(name: str) -> None:
    word = ALL.words[name]
    assert word.summary
    assert all(port.meaning for port in (*word.inputs, *word.outputs))
    assert all(setting.meaning for setting in word.settings)


@pytest.mark.parametrize("name", sorted(ALL.words))
def test_the_example_of_a_word_is_a_node_without_mistake(name: str, tmp_path: Path) -> None:
    path = tmp_path / "example.yaml"
    path.write_text(ALL.words[name].example, encoding="utf-8")
    problems = Problems()
    value = read_file(path, "example.yaml", problems)
    reading = Reading(InstalledCatalogue(), problems, regions=REGIONS)
    node = NodeReader(reading, TREES).node(value)
    problems.raise_errors()
    assert node is not None
    assert name in path.read_text(encoding="utf-8")


def test_a_leaf_is_read_from_its_class() -> None:
    word = leaf_word("Tilt", Tilt, "boom")
    assert (word.kind, word.package, word.form) == ("action", "boom", ("run: Tilt",))
    assert word.summary == "Tilt the cabin. This is the summary."
    assert word.claims == ("cabin",)
    assert [(one.name, one.type, one.optional, one.meaning) for one in word.inputs] == [
        ("by", "str", False, "Who."),
        ("more", "int", True, "How much more."),
    ]
    angle, side, quietly = word.settings
    assert (angle.type, angle.unit, angle.default, angle.bounds) == (
        "angle",
        "rad",
        "0.5",
        "> 0, ≤ 1",
    )
    assert (side.type, side.unit, side.default, side.bounds) == ("text", "", "", "")
    assert (quietly.type, quietly.default) == ("true or false", "required")


def test_an_example_has_units_and_leaves_out_what_may_be_missing() -> None:
    assert leaf_word("Tilt", Tilt, "boom").example.splitlines() == [
        "run: Tilt",
        "with: {angle: 28.6 deg, side: left, quietly: true}",
        'in: {by: "{by}"}',
    ]


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("scanswing", "no word 'scanswing'. Did you mean 'ScanSwing'?"),
        ("SelectLargst", "no word 'SelectLargst'. Did you mean 'SelectLargest'?"),
        ("fallbak", "no word 'fallbak'. Did you mean 'fallback'?"),
        ("xyzzy", "no word 'xyzzy'; `executive words` lists all"),
    ],
)
def test_an_unknown_word_is_refused_with_the_nearest(name: str, told: str) -> None:
    with pytest.raises(ConfigError) as refused:
        ALL.word(name)
    assert str(refused.value) == told


def test_a_leaf_that_cannot_be_imported_says_why() -> None:
    known = Vocabulary({}, {"Boom": "behaviour plugin 'Boom' cannot be loaded: no numpy"})
    with pytest.raises(ConfigError, match="no numpy"):
        known.word("Boom")
