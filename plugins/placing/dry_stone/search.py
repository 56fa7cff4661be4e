"""What one search for the next stone has found so far."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from executive_plugins.placing.dry_stone.failed_places import FailedPlaces
from executive_plugins.placing.dry_stone.parts import Generator, Place
from executive_plugins.placing.dry_stone.refusals import Refusals

from executive.arrays import Float
from executive.interfaces.building import MayGoOn
from executive.messages.building import AsBuilt
from executive.messages.solid_stone import SolidStone


@dataclass(slots=True)
class Search:
    """The search for one stone.

    Attributes:
        generator: Proposes the places.
        built: The structure as it stands.
        usable: All stones that may be used.
        rng: The only source of chance.
        may_go_on: Whether there is time.
        refused: Why stones and places were passed over.
        most_rad: Tilt beyond which a place is left out as the stone rolls to rest there [rad].
        again: Tells the places at which releases have failed.
        found: The best places of each stone that was gone through, by its name, as many as are
            kept when all stones are gone through again.
        checked: Stone and pose of the places that were checked.
        rested: The places at which stones rest, by stone and pose as they first touch; none if a
            stone tilts away.
        failed: Where a stone did not hold, from above [m], shape (2,) each.
    """

    generator: Generator
    built: AsBuilt
    usable: Sequence[SolidStone]
    rng: np.random.Generator
    may_go_on: MayGoOn
    refused: Refusals
    most_rad: float
    again: FailedPlaces
    found: dict[str, Sequence[Place]] = field(default_factory=dict)
    checked: set[tuple[str, bytes]] = field(default_factory=set)
    rested: dict[tuple[str, bytes], Sequence[Place]] = field(default_factory=dict)
    failed: list[Float] = field(default_factory=list)

    def go_on_with(self, generator: Generator, most_rad: float) -> None:
        """Propose places by this generator from now on, and leave them out beyond this tilt."""
        if generator is not self.generator:
            self.generator, self.found = generator, {}
        if most_rad != self.most_rad:
            self.most_rad, self.rested = most_rad, {}

    def unchecked(self, places: Sequence[Place]) -> list[Place]:
        """Return the places that were not checked yet."""
        return [one for one in places if key_of(one) not in self.checked]


def key_of(place: Place) -> tuple[str, bytes]:
    """Return what tells a stone at a place from all others."""
    return place.stone.name, place.T_map_stone.tobytes()


def until(budget_s: float | None, may_go_on: MayGoOn) -> MayGoOn:
    """Return what says the same for a time from now on [s], and False after that."""
    if budget_s is None:
        return may_go_on
    end_s = time.monotonic() + budget_s
    return lambda: time.monotonic() < end_s and may_go_on()
