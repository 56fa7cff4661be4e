"""One stone among stones that hold still, in both models of their shapes."""

from collections.abc import Sequence

from executive_plugins.physics.stone_world import WorldRules
from executive_plugins.physics.trial import Trial
from executive_plugins.placing.dry_stone.other_shapes import OtherShapes
from executive_plugins.placing.dry_stone.settings import CheckSettings

from executive.arrays import Float
from executive.messages.building import AsBuilt
from executive.messages.solid_stone import SolidStone


def rules_of(settings: CheckSettings) -> WorldRules:
    """Return how the world is simulated in which places are checked."""
    return WorldRules(settings.step_s, settings.friction, settings.pieces, is_convex_whole=True)


class FixedNeighbours:
    """The worlds of one stone and of the fixed stones around it.

    Attributes:
        is_alone: Whether there is no other stone.
        trial: The stone is released in this one.
        others: Where it came to rest it must stay in this one.
    """

    def __init__(
        self, part: AsBuilt, rest: Sequence[Float], stone: SolidStone, settings: CheckSettings
    ) -> None:
        """Build both worlds.

        Args:
            part: The stones around it.
            rest: Where they rest in the first model of their shapes, (4, 4) each.
            stone: The stone.
            settings: Of the check.
        """
        self.is_alone = not rest
        self.trial = Trial(part, stone, rules_of(settings), rest, [True] * len(rest))
        self.others = OtherShapes(part, rest, stone, settings)
