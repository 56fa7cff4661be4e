"""Which known stones are meant: the criteria that the leaves about stones share."""

from collections.abc import Callable, Mapping
from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field, model_validator

from executive.arrays import Float
from executive.config import CubicMeters, Kilograms, Meters, Settings
from executive.geometry.pose import inverse, transform
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.context import Context
from executive.leaf.region_name import RegionName
from executive.messages.stone import Stone, StoneState

Order = Literal[
    "most_points", "largest", "smallest", "longest", "shortest", "nearest", "farthest",
    "leftmost", "rightmost", "first_found",
]  # fmt: skip
_Volume = Annotated[CubicMeters, Field(ge=0, le=1000)]
_Length = Annotated[Meters, Field(ge=0, le=100)]
_Mass = Annotated[Kilograms, Field(ge=0, le=1e6)]


class StoneFilter(Settings):
    """Criteria on a stone; all that are given must hold. What is not given does not count."""

    min_volume: _Volume | None = Field(None, description="Smallest volume, included [m³].")
    max_volume: _Volume | None = Field(None, description="Volume from which on it is too large.")
    min_length: _Length | None = Field(None, description="Smallest longest side, included [m].")
    max_length: _Length | None = Field(None, description="Longest side that is too long [m].")
    min_mass: _Mass | None = Field(None, description="Smallest mass, included [kg].")
    max_mass: _Mass | None = Field(None, description="Mass from which on it is too heavy [kg].")
    touching: RegionName | None = Field(
        None, description="Region that its outline from above comes into, by the margin or less."
    )
    inside: RegionName | None = Field(None, description="Region that its whole outline lies in.")
    off: RegionName | None = Field(
        None, description="Region that its outline keeps off, by more than the margin."
    )
    max_distance: _Length | None = Field(
        None, description="Distance of its centroid from the chassis that is too far [m]."
    )
    margin: Meters = Field(
        0.0, ge=0, le=10, description="Distance from a region that counts as touching [m]."
    )
    states: tuple[StoneState, ...] = Field(
        (StoneState.ON_GROUND,), min_length=1, description="States, one of which it has."
    )
    side: Literal["left", "right", "ahead", "behind"] | None = Field(
        None, description="Side of the chassis on which its centroid lies."
    )

    @model_validator(mode="after")
    def _check_ranges(self) -> "StoneFilter":
        for what in ("volume", "length", "mass"):
            low, high = getattr(self, f"min_{what}"), getattr(self, f"max_{what}")
            if low is not None and high is not None and low >= high:
                raise ValueError(f"min_{what} must be less than max_{what}, got {low} and {high}")
        return self


class OrderedStones(StoneFilter):
    """Criteria, and the order of the stones that meet them."""

    order: Order = Field("largest", description="Which stone comes first.")


class _Known(NamedTuple):
    """A stone, and its centroid seen from the chassis [m], shape (3,)."""

    stone: Stone
    centroid_base: Float


def matching_stones(context: Context, wanted: StoneFilter) -> list[Stone]:
    """Return the known stones that meet all criteria, by id.

    Args:
        context: The leaf's view of the mission; it needs objects.
        wanted: The criteria.
    """
    return [one.stone for one in _known(context) if _meets(context, one, wanted)]


def ordered_stones(context: Context, wanted: OrderedStones) -> list[Stone]:
    """Return the known stones that meet all criteria, in their order; equal ones by id."""
    kept = [one for one in _known(context) if _meets(context, one, wanted)]
    rank = _RANKS[wanted.order]
    return [one.stone for one in sorted(kept, key=lambda one: (rank(one), one.stone.id))]


def words_of(wanted: StoneFilter) -> str:
    """Return the criteria for a sentence: `on_ground, min_volume 0.5`."""
    given = wanted.model_dump(mode="json", exclude_none=True, exclude_defaults=True)
    others = [f"{name} {value}" for name, value in given.items() if name not in ("states", "order")]
    return ", ".join([" or ".join(wanted.states), *others])


def _known(context: Context) -> list[_Known]:
    T_base_map = inverse(context.state().T_map_base)
    stones = context.use(ObjectDatabase).stones()
    return [_Known(one, transform(T_base_map, one.centroid_map[None])[0]) for one in stones]


def _meets(context: Context, one: _Known, wanted: StoneFilter) -> bool:
    """Return whether a stone meets all criteria; those that cost least are asked first."""
    stone = one.stone
    return (
        stone.state in wanted.states
        and (wanted.side is None or _SIDES[wanted.side](one.centroid_base))
        and _within(lambda: float(np.hypot(*one.centroid_base[:2])), None, wanted.max_distance)
        and _lies(context, stone, wanted)
        and _within(lambda: stone.length_m, wanted.min_length, wanted.max_length)
        and _within(lambda: stone.volume_m3, wanted.min_volume, wanted.max_volume)
        and _within(lambda: stone.mass_kg, wanted.min_mass, wanted.max_mass)
    )


def _within(value: Callable[[], float], low: float | None, high: float | None) -> bool:
    if low is None and high is None:
        return True
    got = value()
    return (low is None or got >= low) and (high is None or got < high)


def _lies(context: Context, stone: Stone, wanted: StoneFilter) -> bool:
    """Return whether a stone lies where the criteria on regions say."""
    if wanted.touching is wanted.inside is wanted.off is None:
        return True
    outline = stone.outline_map

    def touches(name: str) -> bool:
        return context.region(name).touches(outline, wanted.margin)

    def holds(name: str) -> bool:
        return bool((context.region(name).depth_m(outline) >= 0).all())

    return (
        (wanted.touching is None or touches(wanted.touching))
        and (wanted.off is None or not touches(wanted.off))
        and (wanted.inside is None or holds(wanted.inside))
    )


_SIDES: Mapping[str, Callable[[Float], bool]] = {
    "left": lambda centroid: bool(centroid[1] > 0),
    "right": lambda centroid: bool(centroid[1] <= 0),
    "ahead": lambda centroid: bool(centroid[0] > 0),
    "behind": lambda centroid: bool(centroid[0] <= 0),
}
_RANKS: Mapping[str, Callable[[_Known], float]] = {
    "most_points": lambda one: -len(one.stone.points_map),
    "largest": lambda one: -one.stone.volume_m3,
    "smallest": lambda one: one.stone.volume_m3,
    "longest": lambda one: -one.stone.length_m,
    "shortest": lambda one: one.stone.length_m,
    "nearest": lambda one: float(np.hypot(*one.centroid_base[:2])),
    "farthest": lambda one: -float(np.hypot(*one.centroid_base[:2])),
    "leftmost": lambda one: -_bearing(one),
    "rightmost": lambda one: _bearing(one),
    "first_found": lambda one: 0.0,
}


def _bearing(one: _Known) -> float:
    """Return the direction of a stone from the chassis, to the left of its front positive [rad]."""
    return float(np.arctan2(one.centroid_base[1], one.centroid_base[0]))
