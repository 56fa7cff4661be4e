"""A small catalogue, and missions from the text of their trees."""

from dataclasses import dataclass
from typing import Any

import pytest

from executive.arrays import Float
from executive.config import Settings
from executive.interfaces.plugin import Plugin
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.outcome import Outcome
from executive.tree.catalogue import TableCatalogue
from executive.tree.load import load_mission

HEADER = "api: 1\nmission: small\nplugins: {robot: still, estimation: still}\n"


@dataclass(frozen=True, slots=True, eq=False)
class Rock:
    """A rock.

    Attributes:
        number: Its number.
        centre_m: Its centre [m], shape (3,).
        hardness: How hard it is.
        corners: Its corners, without a stated form.
    """

    number: int
    centre_m: Float
    hardness: float
    corners: Float

    @property
    def mass_kg(self) -> float:
        """Mass [kg]."""
        raise AssertionError("a stand-in makes it up")


@dataclass(frozen=True)
class Found:
    """What is found.

    Attributes:
        rock: The rock.
        count: How many there are.
    """

    rock: Rock
    count: int


class TurnSettings(Settings):
    angle: float = 0.0


def never(*args: object) -> Any:
    raise AssertionError("a dry run calls no leaf")


class Look(Action):
    """Look for a rock."""

    def __init__(self, settings: Settings, context: object) -> None:
        never()

    def run(self) -> Steps[Found]:
        """Look."""
        yield never()


class Turn(Action[TurnSettings]):
    """Turn."""

    def run(self, rock: Rock | None = None) -> Steps[None]:
        """Turn.

        Args:
            rock: Towards it.
        """
        yield never()


class Calm(Condition):
    """Whether the wind is low."""

    def check(self) -> Outcome[None]:
        """Ask."""
        return never()


class Seen(Condition):
    """Whether a rock is seen."""

    def check(self) -> Outcome[Found]:
        """Ask."""
        return never()


LEAVES = {leaf.__name__: leaf for leaf in (Look, Turn, Calm, Seen)}
PLUGINS = {"robot": {"still": Plugin}, "estimation": {"still": Plugin}}


@pytest.fixture
def mission(tmp_path):
    """Load a mission from the text of its tree `main`, or of all its trees."""

    def load(main: str, head: str = ""):
        path = tmp_path / "small.yaml"
        body = "".join(f"    {line}\n" for line in main.strip("\n").splitlines())
        path.write_text(f"{HEADER}{head}trees:\n  main:\n{body}", encoding="utf-8")
        return load_mission(str(path), (), TableCatalogue(LEAVES, PLUGINS))

    return load


@pytest.fixture
def mocks(tmp_path):
    """Write a file of mocks."""

    def write(text: str):
        path = tmp_path / "mocks.yaml"
        path.write_text(f"api: 1\n{text}", encoding="utf-8")
        return path

    return write
