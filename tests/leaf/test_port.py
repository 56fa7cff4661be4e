"""The ports of a leaf are read from its signature, and a signature that says too little is told."""

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any

import pytest

from executive.config import NoSettings
from executive.errors import ConfigError
from executive.interfaces.mapping import Mapper
from executive.interfaces.robot import Robot
from executive.leaf.action import Action, Condition, Leaf, Steps
from executive.leaf.claims import Part
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.port import Port, inputs_of, outputs_of, section, written_by


@dataclass(frozen=True)
class Seen:
    """What is seen.

    Attributes:
        stone: Id of the stone,
            as the database has it.
        height_m: Its height [m].

    Source: made up.
    """

    stone: int
    height_m: float | None = None


@dataclass(frozen=True)
class Trouble:
    """What is in the way.

    Attributes:
        stone: Another stone.
        told: What is told.
    """

    stone: str
    told: str


class Look:
    def run(self, stone: int, hold: str | None = None) -> Steps[Seen]:
        """Look.

        Args:
            stone: Which stone.
            hold (str): How it
                is held.

        Returns:
            nothing: Of interest.
        """
        yield None
        return succeeded(Seen(stone))

    def several(self, *, stone: int) -> Outcome[Seen | Trouble | None]:
        return failed("no")

    def stars(self, *stones: int) -> Outcome[None]:
        return failed("no")

    def words(self, **stones: int) -> Outcome[None]:
        return failed("no")

    def typeless(self, stone) -> Outcome[None]:  # type: ignore[no-untyped-def]
        return failed("no")

    def preset(self, stone: int = 3) -> Outcome[None]:
        return failed("no")

    def resultless(self) -> None:
        """Do."""

    def unannotated(self):  # type: ignore[no-untyped-def]
        """Do."""

    def plain(self) -> Outcome[int]:
        return failed("no")

    def waits(self) -> Generator[None, None, int]:
        yield None
        return 1


def test_parameters_are_inputs_and_the_fields_of_the_result_are_outputs() -> None:
    assert inputs_of(Look.run) == {
        "stone": Port(int, "Which stone."),
        "hold": Port(str, "How it is held.", optional=True),
    }
    assert outputs_of(Look.run) == {
        "stone": Port(int, "Id of the stone, as the database has it."),
        "height_m": Port(float, "Its height [m].", optional=True),
    }


def test_of_several_results_the_first_is_that_of_a_success() -> None:
    assert outputs_of(Look.several) == {
        "stone": Port(int, "Id of the stone, as the database has it."),
        "height_m": Port(float, "Its height [m].", optional=True),
        "told": Port(str, "What is told.", optional=True),
    }
    assert inputs_of(Look.several) == {"stone": Port(int, "")}
    assert outputs_of(Look.stars) == {}


@pytest.mark.parametrize(
    ("method", "told"),
    [
        (Look.stars, "Look.stars: input 'stones' is a star argument; name each input port"),
        (Look.words, "Look.words: input 'stones' is a star argument; name each input port"),
        (Look.typeless, "Look.typeless: input 'stone' has no type"),
        (Look.preset, "Look.preset: input 'stone' has the default 3; only None may be"),
    ],
)
def test_an_input_that_says_too_little_is_refused(method: Any, told: str) -> None:
    with pytest.raises(ConfigError) as caught:
        inputs_of(method)
    assert str(caught.value) == told


@pytest.mark.parametrize("method", [Look.resultless, Look.unannotated, Look.waits])
def test_a_method_without_a_result_is_refused(method: Any) -> None:
    with pytest.raises(ConfigError, match="declares no result; annotate it '-> Steps"):
        outputs_of(method)


def test_a_result_that_is_no_dataclass_is_refused() -> None:
    with pytest.raises(ConfigError, match=r"Look\.plain returns <class 'int'>, which is no"):
        outputs_of(Look.plain)


def test_what_an_outcome_brings_is_written_by_name_and_none_is_not() -> None:
    assert written_by(succeeded(Seen(3, 0.5))) == {"stone": 3, "height_m": 0.5}
    assert written_by(succeeded(Seen(3))) == {"stone": 3}
    assert written_by(succeeded()) == {}
    assert written_by(Outcome(True, "", outputs=7)) == {}


def test_a_section_ends_where_the_next_one_begins() -> None:
    doc = "Do.\n\nArgs:\n    one: First\n        line.\n\n    two: Second.\nRaises:\n    three: No."
    assert section(doc, "Args") == {"one": "First line.", "two": "Second."}
    assert section(doc, "Raises") == {"three": "No."}
    assert section(doc, "Returns") == section(None, "Args") == {}


class Drives(Action):
    """Drive."""

    needs = (Mapper, Robot)

    def run(self) -> Steps[None]:
        yield None
        return succeeded()


class Thinks(Action):
    """Think."""

    needs = (Mapper,)

    def run(self) -> Steps[None]:
        yield None
        return succeeded()


class Asks(Condition):
    """Ask."""

    needs = (Robot,)
    claims = ()

    def check(self) -> Outcome[Seen]:
        return succeeded(Seen(1))


class Says(Thinks):
    """Say."""

    claims = (Part.JAWS,)
    on_resume = OnResume.VERIFY


def test_a_leaf_that_needs_the_robot_claims_the_machine_and_fails_when_it_is_cut_off() -> None:
    assert (Drives.parts(), Drives.resumes()) == ((Part.MACHINE,), OnResume.FAIL)
    assert (Thinks.parts(), Thinks.resumes()) == ((), OnResume.REDO)


def test_what_a_leaf_declares_stands() -> None:
    assert (Asks.parts(), Asks.resumes()) == ((), OnResume.REDO)
    assert (Says.parts(), Says.resumes()) == ((Part.JAWS,), OnResume.VERIFY)
    assert set(Asks.outputs) == {"stone", "height_m"}


def test_a_leaf_that_says_it_verifies_has_to() -> None:
    leaf = Says(NoSettings(), None)  # type: ignore[arg-type]
    with pytest.raises(NotImplementedError, match="Says declares VERIFY and has no `verify`"):
        leaf.verify()


def test_a_leaf_remembers_all_but_its_settings_and_its_context() -> None:
    leaf: Leaf[Any] = Thinks(NoSettings(), None)  # type: ignore[arg-type]
    leaf.restore({"tries": 3})
    assert leaf.state == {"tries": 3}
    assert leaf.tries == 3  # type: ignore[attr-defined]
