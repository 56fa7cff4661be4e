"""The provenance of the figures in a machine's description."""

from enum import StrEnum
from typing import Annotated

from pydantic import BeforeValidator, Field, model_validator

from executive.config import Settings

REST = "rest"


class Provenance(StrEnum):
    """Where a figure comes from, the most trusted kind first."""

    MEASURED = "measured"  # on the machine, or in trials of the simulated one
    PAPER = "paper"  # a publication, a data sheet, or a published description
    GUESS = "guess"  # an engineer's estimate


def _expand(value: object) -> object:
    return {REST: value} if isinstance(value, str) else value


# One kind for a whole block, or kinds by field name and `rest` for the other fields.
ByField = Annotated[dict[str, Provenance], BeforeValidator(_expand)]


class Sourced(Settings):
    """A block of figures with their provenance."""

    provenance: ByField = Field(
        description="measured, paper or guess: one for the block, or one by field name, with "
        "`rest` for the other fields."
    )

    @model_validator(mode="after")
    def _check_provenance(self) -> "Sourced":
        unknown = sorted(set(self.provenance) - set(type(self).model_fields) - {REST})
        if unknown:
            raise ValueError(
                f"provenance names {', '.join(unknown)}, which the block does not have; "
                "use field names"
            )
        if REST not in self.provenance:
            raise ValueError("provenance lacks `rest`, that of the fields it does not name")
        return self

    def provenance_of(self, field: str) -> Provenance:
        """Return where a field's figure comes from."""
        return self.provenance.get(field, self.provenance[REST])
