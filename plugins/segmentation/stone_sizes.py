"""Sizes of the stones that a machine can work with."""

from dataclasses import dataclass

import numpy as np

from executive.machine.machine import Machine

_LIGHTEST_KG_M3 = 2200.0  # sandstone and lava; a lighter stone of the same mass is larger
_SLIMMEST = (
    2.55  # longest side over the cube root of the volume: 99 of 100 scanned stones have less
)
_ZINGG = 2 / 3  # middle side of a stone in its longest, between rods and discs (Zingg 1935)


@dataclass(frozen=True, slots=True)
class StoneSizes:
    """What the jaws can hold and the arm can lift.

    Attributes:
        least_m: Smallest longest side: a stone of two thirds of it is as wide as a tooth [m].
        most_m: Largest longest side, that of a slim and light stone of the heaviest load [m].
        width_m: Largest opening of the jaws, which no stone's shortest side exceeds [m].
        heap_m: Largest width of a heap: what the tips reach on both sides [m].
    """

    least_m: float
    most_m: float
    width_m: float
    heap_m: float


NO_MACHINE = StoneSizes(
    0.25, 3.0, np.inf, 20.0
)  # where no machine is known, those of an excavator of 12 t


def stone_sizes(machine: Machine) -> StoneSizes:
    """Return the sizes of stones for a machine."""
    volume_m3 = machine.payload_kg / _LIGHTEST_KG_M3
    return StoneSizes(
        least_m=2 * machine.gripper.tooth_half_width_m / _ZINGG,
        most_m=_SLIMMEST * float(volume_m3 ** (1 / 3)),
        width_m=machine.gripper.max_opening_m,
        heap_m=2 * machine.reach_m,
    )
