"""Cells of a campaign: combinations of levels, and what the runs of each are given."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, Protocol

from executive.campaign.description.factors import Factor, Level
from executive.campaign.description.paths import Paths
from executive.tree.override import PlacedSetting
from executive.tree.value import Value


@dataclass(frozen=True, slots=True)
class Cell:
    """One combination of levels.

    Attributes:
        levels: The level of each factor.
        settings: Settings of its runs, in the order in which they are laid over each other.
        mission: The mission of its runs, if one is chosen.
    """

    levels: Mapping[str, str]
    settings: tuple[PlacedSetting, ...]
    mission: Value | None

    def with_absolute(self, paths: Paths) -> "Cell":
        """Return the cell with its relative paths made absolute."""
        settings = (replace(one, value=paths.made_absolute(one.value)) for one in self.settings)
        return replace(self, settings=tuple(settings))


class Checker(Protocol):
    """Checks the cells of one kind of work."""

    def arguments(self, cell: Cell) -> Mapping[str, Any] | None:
        """Return what the runs of a cell are given, or None after every mistake was noted."""

    def finish(self) -> None:
        """Note what no cell has used, after all of them were checked."""


def cells_of(common: Sequence[PlacedSetting], factors: Sequence[Factor]) -> Iterator[Cell]:
    """Yield the full grid; the levels of the last factor change first."""
    for levels in product(*(factor.levels for factor in factors)):
        chosen = zip(factors, levels, strict=True)
        yield Cell(
            levels={factor.name: level.name for factor, level in chosen},
            settings=_ordered([*common, *(s for level in levels for s in level.settings)]),
            mission=_mission(levels),
        )


def _mission(levels: Sequence[Level]) -> Value | None:
    return next((level.mission for level in levels if level.mission is not None), None)


def _ordered(settings: Sequence[PlacedSetting]) -> tuple[PlacedSetting, ...]:
    """Put the choice of plugins first: it takes back the settings of the plugin before it."""
    return tuple(sorted(settings, key=lambda one: not _chooses_plugin(one.key)))


def _chooses_plugin(key: str) -> bool:
    return "." not in key or key.endswith(".plugin")
