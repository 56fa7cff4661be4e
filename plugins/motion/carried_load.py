"""What a machine that may tip can still lift on its way with a stone."""

from executive.arrays import Float
from executive.machine.lift_capacity import LiftCapacity

# Share of the mass by which a posture on the way may bear more: the curve between such postures
# bulges by that.
_ROOM = 0.05
# A load is told with two deviations more than it was weighed with, and these are a fifteenth of it
# at most: where a tenth is missing, whoever judges by what was weighed refuses it, too.
_HOPELESS = 0.1


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

    def is_hopeless(self, spare_kg: float) -> bool:
        """Return whether so little capacity is far too little, however the load is carried."""
        return spare_kg < -_HOPELESS * self._mass_kg

    def may_pass(self, q: Float) -> bool:
        """Return whether the machine may carry the stone through a posture, with some room.

        None is asked for beyond the payload of the gripper, which is the same in all postures.
        """
        capacity = self._capacity.at(q)
        return capacity.rated_kg >= min((1.0 + _ROOM) * self._mass_kg, capacity.payload_kg)
