"""Times of a log without satellite fixes."""

from collections.abc import Sequence

import numpy as np

from executive.estimate.material import Material
from executive.messages.gnss import GnssFix

_MISSED = 2.5  # usual intervals between two fixes beyond which some are missing
_LEAST_S = 1.0


def silences(material: Material) -> Sequence[tuple[float, float]]:
    """Return where no fix was fed for longer than usual, since the log's first message [s]."""
    fixes = (a.observation for a in material.arrivals if isinstance(a.observation, GnssFix))
    fed = (fix for fix in fixes if not any(drop.takes(fix) for drop in material.drops))
    stamps = np.unique([fix.stamp_s for fix in fed])
    if len(stamps) < 2:
        return ()
    steps_s = np.diff(stamps)
    longest_s = max(_LEAST_S, _MISSED * float(np.median(steps_s)))
    return tuple(
        (float(stamps[i]), float(stamps[i + 1])) for i in np.flatnonzero(steps_s > longest_s)
    )
