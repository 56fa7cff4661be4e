"""Say what is to be built."""

from dataclasses import dataclass

from pydantic import Field

from executive.leaf.action import Condition
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, succeeded
from executive.leaf.structure_shape import StructureShape
from executive.messages.structure import Structure


@dataclass(frozen=True, slots=True)
class StructureDescribed:
    """What is to be built.

    Attributes:
        structure: Centre line, thickness, height and faces, in the map.
    """

    structure: Structure


class DescribeStructureSettings(StructureShape):
    label: str = Field("wall", min_length=1, description="What people call the structure.")


class DescribeStructure(Condition[DescribeStructureSettings]):
    """Describe a wall, a row, a ring or a cairn by its settings, in the map."""

    on_resume = OnResume.REDO

    def check(self) -> Outcome[StructureDescribed]:
        structure = self.settings.shaped(self.settings.label)
        told = f"{structure.name}, {structure.length_m:.1f} m long, {structure.height_m:.1f} m high"
        return succeeded(StructureDescribed(structure), told)
