"""A mass that was weighed."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Weight:
    """What the efforts of the arm say of the stone in the jaws.

    Attributes:
        mass_kg: Its mass [kg].
        std_kg: Standard deviation of the mass [kg].
    """

    mass_kg: float
    std_kg: float

    def __str__(self) -> str:
        return f"{self.mass_kg:.0f} ± {self.std_kg:.0f} kg"
