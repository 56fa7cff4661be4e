"""Settings of the physics plugins, apart from them: reading a mission imports no algorithm."""

from dataclasses import replace

from executive_plugins.physics.surface import ContactModel, Surface
from pydantic import Field

from executive.config import Settings


class ContactSettings(Settings):
    """Numbers that replace those of the scenario, for all pairs of materials alike."""

    friction: float | None = Field(
        None,
        gt=0,
        le=2,
        description="Coulomb friction coefficient of all surfaces; by scenario if not given.",
    )
    torsional_friction_m: float | None = Field(
        None,
        ge=0,
        le=0.5,
        description="Moment about the normal over the normal force [m]; by scenario if not given.",
    )
    impratio: float = Field(
        100.0, ge=1, le=1000, description="Stiffness of friction over that of normal forces."
    )

    def replaced(self, contact: ContactModel) -> ContactModel:
        """Return a contact model with the numbers that are given."""
        steel, soil, stone = map(self._replaced, (contact.steel, contact.soil, contact.stone))
        return ContactModel(steel, soil, stone, self.impratio)

    def _replaced(self, surface: Surface) -> Surface:
        given = {"friction": self.friction, "torsional_m": self.torsional_friction_m}
        return replace(surface, **{k: v for k, v in given.items() if v is not None})
