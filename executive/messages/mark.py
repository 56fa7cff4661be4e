"""A marked place: a point with a text, for people who look at the site."""

from dataclasses import dataclass

from executive.arrays import Float, checked


@dataclass(frozen=True, slots=True, eq=False)
class Mark:
    """A text at a place.

    Attributes:
        text: What is said about it.
        position_map: The place [m], shape (3,).
    """

    text: str
    position_map: Float

    def __post_init__(self) -> None:
        object.__setattr__(self, "position_map", checked("position_map", self.position_map, 3))
