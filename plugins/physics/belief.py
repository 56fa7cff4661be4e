"""What a rehearsal assumes of contacts: those of a scenario, and a range of friction of steel.

A planner is told by its settings which scenario to assume. It may be another one than that of the
world, as nobody tells a mission how wet the stones are.
"""

from dataclasses import dataclass
from typing import Literal

from executive_plugins.physics.scenario import Scenario, contact_of
from executive_plugins.physics.surface import ContactModel, Surface, uniform

from executive.machine.gripper import Gripper

# A scenario, or stones that may be wet or dry: the soil of `nominal`, and friction of both.
Assumed = Literal["wet_to_dry", "kind", "nominal", "wet", "harsh"]

# Rehearsals that assume `kind` have less friction and torsion than the world `kind` (0.6, 0.08 m),
# as they had before there were scenarios: all figures of `kind` were drawn so.
_KIND_TORSIONAL_M = 0.05
# Friction of steel on stone. Outside `kind` the range reaches half of the way from `nominal` to
# `wet`, on both sides of the scenario's own number; `wet_to_dry` is both of these ranges.
_FRICTION: dict[Assumed, tuple[float, float]] = {
    "wet_to_dry": (0.25, 0.45),
    "kind": (0.45, 0.65),
    "nominal": (0.35, 0.45),
    "wet": (0.25, 0.35),
    "harsh": (0.25, 0.35),
}


@dataclass(frozen=True, slots=True)
class Belief:
    """The contacts that a rehearsal assumes.

    Attributes:
        scenario: Whose contacts they are, but for the friction of steel.
        gripper: The gripper that touches the stone.
        friction: Least and largest friction of steel on stone.
    """

    scenario: Scenario
    gripper: Gripper
    friction: tuple[float, float]

    @property
    def least(self) -> float:
        """The least friction of steel on stone."""
        return self.friction[0]

    @property
    def middle(self) -> float:
        """The middle of the range of friction."""
        return sum(self.friction) / 2

    def contact(self, friction: float) -> ContactModel:
        """Return the contacts with a friction of steel on stone.

        The moment about the normal is in proportion to it, as that of a patch is; in `kind` all
        materials have this friction, and the moment is the same for all.
        """
        if self.scenario == "kind":
            return uniform(Surface(friction, _KIND_TORSIONAL_M))
        return contact_of(self.scenario, self.gripper).with_steel(friction)


def belief_of(
    assumed: Assumed, gripper: Gripper, friction: tuple[float, float] | None = None
) -> Belief:
    """Return what is assumed, with its own range of friction of steel if none is given."""
    scenario = "nominal" if assumed == "wet_to_dry" else assumed
    return Belief(scenario, gripper, friction or _FRICTION[assumed])
