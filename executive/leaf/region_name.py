"""The name of a region of the mission, as the type of a leaf's setting."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field


@dataclass(frozen=True, slots=True)
class NamesRegion:
    """Marks the type of a setting as the name of a region; the check knows the mission's names."""


RegionName = Annotated[str, Field(min_length=1), NamesRegion()]
