"""An entry of a stone's history, by which its pose can be traced back."""

from dataclasses import dataclass

from executive.arrays import Float, checked
from executive.messages.stone import StoneState


@dataclass(frozen=True, slots=True, eq=False)
class StoneEvent:
    """A change in the object database.

    Attributes:
        stamp_s: Time of the change on the mission's clock [s].
        kind: found, seen, moved, replaced, reshaped, piece, grasp, release, realign, state; other
            databases may have others.
        state: The stone's state afterwards.
        T_map_object: Its pose afterwards, shape (4, 4).
        note: Explanation in words: which sensor, how well it agreed, what was refused.
    """

    stamp_s: float
    kind: str
    state: StoneState
    T_map_object: Float
    note: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "T_map_object", checked("T_map_object", self.T_map_object, 4, 4))
