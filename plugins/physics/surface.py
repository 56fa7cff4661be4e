"""What a contact between two materials is like, and which materials there are."""

from dataclasses import dataclass, replace

# Time constant of a contact that is as stiff as the solver allows at steps of 2.5 to 4 ms [s].
RIGID_S = 0.01


@dataclass(frozen=True, slots=True)
class Surface:
    """The contact of one material with those below it in the order steel, soil, stone.

    Attributes:
        friction: Coefficient of sliding friction.
        torsional_m: Largest moment about the normal over the normal force [m]. A round patch of
            radius R under even pressure has 2/3·µ·R (integrate µ·p·r over the patch).
        rolling_m: Largest moment about a tangent over the normal force: how far the resultant of
            the pressure moves from the centre of the contact before the body rolls [m].
        time_constant_s: Time constant of the contact, critically damped; longer is softer [s].
    """

    friction: float
    torsional_m: float
    rolling_m: float = 0.0
    time_constant_s: float = RIGID_S


def round_patch(
    friction: float, radius_m: float, rolling_m: float = 0.0, time_constant_s: float = RIGID_S
) -> Surface:
    """Return a surface whose contacts are round patches under even pressure."""
    return Surface(friction, 2.0 / 3.0 * friction * radius_m, rolling_m, time_constant_s)


@dataclass(frozen=True, slots=True)
class ContactModel:
    """Contacts by pair of materials.

    The pair takes the surface of the material that stands first in the order steel, soil, stone:
    steel on stone and steel on soil are `steel`, stone on soil is `soil`, stone on stone `stone`.

    Attributes:
        steel: Jaws and links on anything.
        soil: Stones on the ground.
        stone: Stones on stones.
        impratio: Stiffness of friction over that of normal forces. It is a property of the solver:
            with low values a held stone creeps by 1 to 8 mm/s, which no real contact does.
    """

    steel: Surface
    soil: Surface
    stone: Surface
    impratio: float = 100.0

    def with_steel(self, friction: float) -> "ContactModel":
        """Return the model with another friction of steel, and its moment in proportion."""
        share = friction / self.steel.friction
        steel = replace(self.steel, friction=friction, torsional_m=share * self.steel.torsional_m)
        return replace(self, steel=steel)


def uniform(surface: Surface, impratio: float = 100.0) -> ContactModel:
    """Return the model in which all pairs are alike."""
    return ContactModel(surface, surface, surface, impratio)
