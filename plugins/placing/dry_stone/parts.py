"""The three parts of the planner, each replaceable by a class of anybody's package.

A setting `part: my_package.walls:MyScorer` names the class; it is made with the settings of the
part that it replaces. Only its one method counts.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Protocol, TypeVar, cast, runtime_checkable

import numpy as np
from executive_plugins.placing.dry_stone.footing import Footing, Noise

from executive.arrays import Bool, Float
from executive.config import Settings
from executive.errors import ConfigError, did_you_mean
from executive.interfaces.building import MayGoOn
from executive.messages.building import AsBuilt
from executive.messages.solid_stone import SolidStone

Part = TypeVar("Part")
Own = TypeVar("Own", bound=Settings)


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Places for one stone in one orientation, before their stability is known.

    Attributes:
        stone: The stone.
        R: Its rotation, shape (3, 3).
        origins_map: Its origin where it first touches, shape (P, 3) [m].
        measured: What was measured at each place, shape (P,) each, by name: `contact_share`,
            `mean_gap_m`, `support_margin_m`, `largest_support_share`, `outside_share`, `depth_m`,
            `top_m`, `beside_share`, `void_m3` below the stone, `bottom_m` of its lowest point
            above the ground, taken from its top, `rise_m` where it is let go a little beside,
            `joints_closed`, those that it covers less those that it lets run, -1 to 1,
            `along_m`, its length along the structure, `before_m` and `after_m`, what is left free
            of its course on either side,
            `top_gap_m` of its upper side below its highest point, in the mean.
    """

    stone: SolidStone
    R: Float
    origins_map: Float
    measured: Mapping[str, Float]

    def only(self, chosen: Bool) -> "Places":
        """Return those of them that are chosen, shape (P,)."""
        measured = {name: values[chosen] for name, values in self.measured.items()}
        return Places(self.stone, self.R, self.origins_map[chosen], measured)


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """One of them, with the weighted terms of its score and their sum."""

    stone: SolidStone
    T_map_stone: Float
    score: float
    terms: Mapping[str, float]


@dataclass(frozen=True, slots=True, eq=False)
class Stability:
    """What a check found.

    Attributes:
        refusal: Why the place is refused, such as `slides_away`; empty if it holds.
        T_map_settled: Pose in which the stone rests, shape (4, 4).
        worst_m: Largest distance from it of any release under noise [m].
        worst_rad: Largest rotation from it [rad].
        terms: What was measured, by name; added to the terms of the score.
    """

    refusal: str
    T_map_settled: Float
    worst_m: float
    worst_rad: float
    terms: Mapping[str, float]


class Generator(Protocol):
    """Finds where stones can come to lie."""

    def places(
        self,
        built: AsBuilt,
        inventory: Sequence[SolidStone],
        rng: np.random.Generator,
        may_go_on: MayGoOn,
    ) -> Iterator[Sequence[Places]]:
        """Yield all places of one stone after the other, in the order of the inventory."""


@runtime_checkable
class TiltsToRest(Protocol):
    """What a generator may do besides: let a stone tilt at its place, before any check."""

    def at_rest(
        self, place: "Place", built: AsBuilt, inventory: Sequence[SolidStone]
    ) -> Places | None:
        """Return one place, measured in the tilt in which the stone rests; None if it topples."""


@runtime_checkable
class TellsFooting(Protocol):
    """What a generator may do besides: tell how a stone will stand, before any check."""

    def footing(self, place: "Place", built: AsBuilt, noise: Noise, most_rad: float) -> Footing:
        """Return it; a stone that tilts by more than `most_rad` counts as lost."""


class Scorer(Protocol):
    """Ranks places."""

    def score(
        self, places: Places, built: AsBuilt, inventory: Sequence[SolidStone]
    ) -> Mapping[str, Float]:
        """Return weighted terms by name, (P,) each; their sum ranks a place, higher first."""


class StabilityCheck(Protocol):
    """Says whether a stone will rest at a place."""

    def check(
        self, place: Place, built: AsBuilt, rng: np.random.Generator, may_go_on: MayGoOn
    ) -> Stability:
        """Return where the stone comes to rest, or why it does not hold."""


def part_of(
    name: str, kind: str, shipped: Mapping[str, Callable[[Own], Part]], settings: Own
) -> Part:
    """Return a part by its shipped name or by `package.module:Class`, made with its settings.

    Raises:
        ConfigError: If there is no part of that name, or it cannot be imported.
    """
    if name in shipped:
        return shipped[name](settings)
    module, colon, attribute = name.partition(":")
    if not colon:
        raise ConfigError(
            f"building.{kind}.part: no part '{name}'{did_you_mean(name, shipped)}; "
            "one of your own is written as package.module:Class"
        )
    try:
        return cast(Part, getattr(import_module(module), attribute)(settings))
    except (ImportError, AttributeError, TypeError) as error:
        raise ConfigError(f"building.{kind}.part: '{name}' cannot be used: {error}") from error
