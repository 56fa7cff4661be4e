"""A structure as it stands, and the next stone for it: what building planners take and answer."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from executive.arrays import Float, checked
from executive.messages.height_grid import HeightGrid
from executive.messages.solid_stone import SolidStone
from executive.messages.structure import Structure

# Why there is no target: the structure is complete; there is no stone at all; each is too heavy, or
# of a shape that cannot be handled (a needle or a slab); none has a place that holds it; the time
# was over before one was found; it was cancelled.
NoTarget = Literal[
    "complete", "no_stones", "all_too_heavy", "all_unsuitable", "nothing_fits", "out_of_time"
]


@dataclass(frozen=True, slots=True, eq=False)
class StandingStone:
    """A stone of the structure, where it is.

    Attributes:
        stone: Its model.
        T_map_stone: Pose of its frame, shape (4, 4).
    """

    stone: SolidStone
    T_map_stone: Float

    def __post_init__(self) -> None:
        object.__setattr__(self, "T_map_stone", checked("T_map_stone", self.T_map_stone, 4, 4))

    def vertices_map(self) -> Float:
        """Return the vertices of its surface in the map [m], shape (V, 3)."""
        T = self.T_map_stone
        return np.asarray(self.stone.vertices @ T[:3, :3].T + T[:3, 3])


@dataclass(frozen=True, slots=True, eq=False)
class FailedRelease:
    """A release of a stone that did not stay where it was let go.

    Attributes:
        at_map: The stone's middle as it was let go, from above [m], shape (2,).
        radius_m: Radius of a circle with the area of the stone's outline from above [m].
        supports: Names of the stones that were below it, of those that still stand as they did.
    """

    at_map: Float
    radius_m: float
    supports: frozenset[str]

    def __post_init__(self) -> None:
        object.__setattr__(self, "at_map", checked("at_map", self.at_map, 2))


@dataclass(frozen=True, slots=True, eq=False)
class AsBuilt:
    """A structure, the ground it is on, and the stones of it that stand already.

    Attributes:
        structure: What is to be built.
        ground: The ground before the first stone.
        standing: The stones, in the order in which they were placed.
        failed: Releases that failed on stones which stand, oldest first.
        around: Stones that lie near the structure and are none of it, such as those that are to be
            moved into it: nothing is set down over them.
    """

    structure: Structure
    ground: HeightGrid
    standing: tuple[StandingStone, ...] = ()
    failed: tuple[FailedRelease, ...] = ()
    around: tuple[StandingStone, ...] = ()

    def above_ground_m(self, points_map: Float) -> Float:
        """Return the heights of points (M, 3) above the ground below them [m], shape (M,)."""
        return np.asarray(points_map[:, 2] - self.ground.at(points_map[:, :2]))

    def with_standing(self, *standing: StandingStone) -> "AsBuilt":
        """Return the same structure with other stones in place of those that stood."""
        return replace(self, standing=standing)


@dataclass(frozen=True, slots=True, eq=False)
class BuildTarget:
    """A place for one stone.

    Attributes:
        stone: Its name in the inventory.
        T_map_stone: Pose at which it is let go, shape (4, 4).
        T_map_settled: Pose in which it is expected to rest, shape (4, 4).
        approach_map: Direction of the last motion before the release, unit vector, shape (3,).
        release_height_m: How far the stone is above its place when it is let go [m].
        worst_m: Largest distance from the expected rest, of those that were tried under noise [m].
        worst_rad: Largest rotation from it [rad].
        score: Higher is better; comparable within one plan.
        terms: Parts of the score by name, each before its weight.
    """

    stone: str
    T_map_stone: Float
    T_map_settled: Float
    approach_map: Float
    release_height_m: float
    worst_m: float
    worst_rad: float
    score: float
    terms: Mapping[str, float]

    def __post_init__(self) -> None:
        for name in ("T_map_stone", "T_map_settled"):
            object.__setattr__(self, name, checked(name, getattr(self, name), 4, 4))
        object.__setattr__(self, "approach_map", checked("approach_map", self.approach_map, 3))


@dataclass(frozen=True, slots=True, eq=False)
class BuildPlan:
    """Targets for the next stone, best first, or the reason why there is none.

    Attributes:
        targets: Best first; empty if there is none.
        reason: Why there is no target; None if there is one.
        refused: Number of stones and of places that were passed over, by reason.
        detail: The figures behind the reason, in words.
        by_stone: The same numbers as `refused` of each stone, by its name, in the order in which
            they were met: what is told of its best places comes first. Empty if it is not known.
    """

    targets: tuple[BuildTarget, ...]
    reason: NoTarget | None
    refused: Mapping[str, int]
    detail: str = ""
    by_stone: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
