"""Where slots may be, and how they are arranged."""

from dataclasses import dataclass, field

from executive.arrays import Float, checked
from executive.errors import DataError
from executive.messages.region import Region
from executive.messages.stone import Stone


@dataclass(frozen=True, slots=True, eq=False)
class Row:
    """A straight row of stones, their longer sides along it.

    Attributes:
        start_map: Where the first stone begins, in the map [m], shape (2,).
        heading_rad: Direction of the row, from x towards y [rad].
        gap_m: Distance between the faces of neighbours [m].
    """

    start_map: Float
    heading_rad: float
    gap_m: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "start_map", checked("start_map", self.start_map, 2))
        if not self.gap_m >= 0:
            raise DataError(f"the gap between two stones is at least 0 m, got {self.gap_m}")


@dataclass(frozen=True, slots=True, eq=False)
class SlotLayout:
    """Regions to use and to keep off, a row, and the stones that the slots are for.

    Attributes:
        use: Regions, in one of which each stone must lie as a whole; none: anywhere.
        keep_off: Regions that no stone may come into.
        row: The row to place stones in; None leaves the arrangement to the planner.
        stones: The stones that the slots are for; in a row, the first slot is for the first stone.
        standing: The other known stones that lie on the site.
    """

    use: tuple[Region, ...] = field(default=())
    keep_off: tuple[Region, ...] = field(default=())
    row: Row | None = None
    stones: tuple[Stone, ...] = field(default=())
    standing: tuple[Stone, ...] = field(default=())


ANYWHERE = SlotLayout()
