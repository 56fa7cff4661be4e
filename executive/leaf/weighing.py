"""Weigh what is in the jaws, and the least that a stone which hangs free weighs."""

from collections.abc import Generator, Sequence

import numpy as np

from executive.leaf.context import Context
from executive.messages.stone import Stone, StoneState

# Least share of the mass by volume that a stone weighs, two standard deviations below it: found
# stones of several kinds spread by 9 % in density (2,300 to 3,100 kg/m³, evenly), and the hull of a
# surveyed stone by 5 % in volume. Views from one side are smaller than the stone: they err to the
# safe side.
LEAST_SHARE = 0.8
_SPREAD = 0.1  # two standard deviations of stones of one site: 2.5 % in density, 4 % in volume
_SURE = 2.0  # standard deviations of a weight


def hanging_kg(context: Context, window_s: float) -> Generator[None, None, float | None]:
    """Return the mean of the mass in the jaws over a window of time [kg]; None if none is told."""
    began_s, masses = context.now_s(), list[float]()
    while context.now_s() - began_s < window_s:
        yield None
        mass_kg = context.payload_kg()
        if mass_kg is not None:
            masses.append(mass_kg)
    return float(np.mean(masses)) if masses else None


def least_kg(stone: Stone, stones: Sequence[Stone], share: float = LEAST_SHARE) -> float:
    """Return the mass below which the ground carries a part of a stone [kg].

    It is two standard deviations below the mass that was weighed before. Of a stone that was not
    weighed, it is a share of the mass that its volume tells: once stones of the site were weighed
    and placed, nearly that of the lightest of them for its volume.

    Args:
        stone: The stone.
        stones: All known ones.
        share: The share while none was weighed.
    """
    if stone.weight is not None:
        return stone.mass_kg - _SURE * stone.weight.std_kg
    weighed = [one for one in stones if one.weight is not None and one.state is StoneState.PLACED]
    if weighed:
        lightest = min(one.mass_kg / one.mass_by_volume_kg for one in weighed)
        share = max(share, min(lightest, 1.0) - _SPREAD)
    return share * stone.mass_by_volume_kg
