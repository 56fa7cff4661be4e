"""Settings of the physics plugins, apart from them: reading a mission imports no algorithm."""

from pydantic import Field

from executive.config import Settings


class ContactSettings(Settings):
    """Friction of all surfaces; with the defaults the jaws hold a stone of 2.7 t without creep."""

    friction: float = Field(
        0.6, gt=0, le=2, description="Coulomb friction coefficient of steel, stone and ground."
    )
    torsional_friction_m: float = Field(
        0.08, ge=0, le=0.5, description="Size of a contact patch that resists turning [m]."
    )
    impratio: float = Field(
        100.0, ge=1, le=1000, description="Stiffness of friction over that of normal forces."
    )
