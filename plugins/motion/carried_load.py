"""What a machine that may tip can still lift on its way with a stone."""

from executive.arrays import Float
from executive.machine.lift_capacity import LiftCapacity


class CarriedLoad:
    """A stone of a known mass in the jaws.

    Args:
        capacity: Lift capacities of the machine.
        mass_kg: The most that the stone weighs.
    """

    def __init__(self, capacity: LiftCapacity, mass_kg: float) -> None:
        self._capacity, self._mass_kg = capacity, mass_kg

    def spare_kg(self, positions: Float) -> float:
        """Return by how much the rated capacity on a path (m, n) exceeds the mass [kg].

        It is negative where the machine may not lift the stone.
        """
        return self._capacity.along(positions).rated_kg - self._mass_kg
