"""A measurement that waits for the filter to reach its time."""

from collections.abc import Callable
from dataclasses import dataclass, field


@dataclass(order=True, frozen=True)
class Correction:
    """What to do when the filter stands at a time; corrections are ordered by it.

    Attributes:
        stamp_s: Time of the measurement [s].
        apply: Corrects the filter, which stands at that time then.
    """

    stamp_s: float
    apply: Callable[[], None] = field(compare=False)
