"""The shipped scorer: named terms of about 0 to 1, times their weights.

`volume` less `void` is the stone that a place adds to the structure, and the hollow that it shuts.
`height` is that of the stone's bottom: that of its top would have flat stones first, and those
leave a low course. `into` has stones lie with their length into the structure: that is how masons
lay them, as a stone along the face takes the room of two, and rests on less of those below. `gaps`
has the stones of a course stand close, or leave a length between them that others fit into: what
is left besides bears nothing, and is no bed for the next course.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from executive_plugins.placing.dry_stone.parts import Places
from executive_plugins.placing.dry_stone.settings import ScorerSettings

from executive.arrays import Float
from executive.messages.building import AsBuilt
from executive.messages.solid_stone import SolidStone

# Lengths at which a term has reached the end of its scale.
_FACE_M, _MARGIN_M, _UNEVEN_M = 0.3, 0.2, 0.3
_APART_M = 0.075  # of neighbours: 2.5 standard deviations of a release, see `astray`


class Weighted:
    """Terms that dry-stone builders name: one on two, flush with the face, no void, low first."""

    def __init__(self, settings: ScorerSettings) -> None:
        self._weights = settings.weights.model_dump()

    def score(
        self, places: Places, built: AsBuilt, inventory: Sequence[SolidStone]
    ) -> Mapping[str, Float]:
        """Return the weighted terms of places, shape (P,) each."""
        m = places.measured
        largest = max(stone.volume_m3 for stone in inventory)
        extents_m = np.array([stone.extents_m for stone in inventory])
        terms = {
            "volume": np.full(len(places.origins_map), places.stone.volume_m3 / largest),
            "contact": m["contact_share"],
            "void": -m["void_m3"] / largest,
            "height": 1 - np.maximum(0.0, m["bottom_m"]) / built.structure.height_m,
            "face": 1 - np.clip(m["depth_m"] / _FACE_M, 0.0, 1.0),
            "interlock": 1 - m["largest_support_share"],
            "margin": np.clip(m["support_margin_m"] / _MARGIN_M, 0.0, 1.0),
            "beside": m["beside_share"],
            "joints": m["joints_closed"],
            "into": 1 - m["along_m"] / extents_m[:, 0].max(),
            "gaps": -_wasted(m["before_m"], extents_m) - _wasted(m["after_m"], extents_m),
            "flat": 1 - np.clip(m["top_gap_m"] / _UNEVEN_M, 0.0, 1.0),
        }
        return {name: self._weights[name] * value for name, value in terms.items()}


def _wasted(free_m: Float, extents_m: Float) -> Float:
    """Return lengths (P,) of a course times the share of stones that they are too short for.

    In lengths that a stone needs, in the median. A stone that lies on its broad side, with its
    length into the structure, needs the middle one of its extents, and room to either side.
    """
    needed_m = np.sort(extents_m[:, 1]) + 2 * _APART_M
    share = 1 - np.searchsorted(needed_m, free_m, side="right") / len(needed_m)
    return np.asarray(np.minimum(free_m, needed_m[-1]) * share / np.median(needed_m))
