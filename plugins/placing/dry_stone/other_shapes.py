"""Whether a stone stays where it rests when the shapes of all stones are modelled otherwise.

The model of a stone is off its surface by a centimetre in the mean, and by more in hollows
(executive_plugins.physics.convex_pieces). A stone that bears on parts of a model that are not there
finds another rest on the stones themselves, whatever load it bears in the model. Two models of one
scan, of 10 and of 30 pieces, differ from each other as a model does from the scan, so that a stone
that moves from one to the other will move on the real ones. The stones around hold still in this:
only what the shapes do to the new stone is asked for, and a trial takes a fraction of a release.
Stones that are all convex, as those of a mission, have one model, and stay.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from executive_plugins.physics.convex_pieces import is_convex
from executive_plugins.physics.stone_world import WorldRules
from executive_plugins.physics.trial import Bounds, Trial, apart
from executive_plugins.placing.dry_stone.settings import CheckSettings

from executive.arrays import Float
from executive.messages.building import AsBuilt
from executive.messages.solid_stone import SolidStone

_ANY_RAD = np.pi  # rotations are bounded by the releases


class OtherShapes:
    """One stone and those around it in another shape of all of them."""

    def __init__(
        self, part: AsBuilt, rest: Sequence[Float], stone: SolidStone, settings: CheckSettings
    ) -> None:
        """Build the world.

        Args:
            part: The stones that the new one may touch.
            rest: Where they rest in the shapes in which the new one settles, (4, 4) each.
            stone: The new stone.
            settings: Of the check: friction, step, and pieces of the other shape.
        """
        self._most_m = settings.reseated
        self._trial = None
        stones = [stone, *(one.stone for one in part.standing)]
        if settings.other_pieces and not all(_is_convex(one) for one in stones):
            rules = WorldRules(
                settings.step_s, settings.friction, settings.other_pieces, is_convex_whole=True
            )
            self._trial = Trial(part, stone, rules, rest, [True] * len(rest))

    def moves(self, T_map_stone: Float) -> float:
        """Return how far the stone moves from where it rests [m]; infinite if it goes on moving."""
        if self._trial is None:
            return 0.0
        bounds = Bounds(T_map_stone, self._most_m, _ANY_RAD)
        found = self._trial.release(T_map_stone, 0.0, bounds)
        return apart(T_map_stone, found.T_map_settled)[0] if found.is_at_rest else np.inf


@lru_cache(maxsize=128)  # the stones of a structure are asked about at each place
def _is_convex(stone: SolidStone) -> bool:
    return is_convex(stone.vertices, stone.volume_m3)
