"""Weigh what is in the jaws, and the least that a stone which hangs free weighs."""

from collections.abc import Generator, Sequence

import numpy as np

from executive.leaf.context import Context
from executive.leaf.sway import PERIODS_S, level
from executive.messages.stone import Stone, StoneState
from executive.messages.weight import Weight

# Least share of the mass by volume that a stone weighs, two standard deviations below the mean of
# natural stones, 0.88 · (1 - 2 · 0.12): a natural stone fills 0.88 of its convex hull, which
# spreads by 5 % (100 scans), found stones of several kinds spread by 9 % in density (2,300 to
# 3,100 kg/m³, evenly), and the hull of a surveyed stone by 5 % in volume. Views from one side are
# smaller than the stone: they err to the safe side.
LEAST_SHARE = 0.67
# Standard deviation of that share among the stones of one site: 5 % by form, 4 % in volume, 2.5 %
# in density; and for how many stones it counts, as the spread of a few says little.
_ONE_SITE, _ONE_SITE_STONES = 0.07, 4
SURE = 2.0  # standard deviations of a weight
_AGREE, _LEAST_STD_KG = 0.99, 1.0  # no weight is known better
# Where the stone is in the jaws leaves 3 % of its mass open; a sway that leaves half of that open
# adds a tenth to it. Nothing is known of a sway that is slower than the slowest one.
_KNOWN, _LONGEST_S = 0.015, float(PERIODS_S[-1])


def hanging_kg(context: Context, window_s: float) -> Generator[None, None, float | None]:
    """Return the mean of the mass in the jaws over a window of time [kg]; None if none is told."""
    began_s, masses = context.now_s(), list[float]()
    while context.now_s() - began_s < window_s:
        yield None
        mass_kg = context.payload_kg()
        if mass_kg is not None:
            masses.append(mass_kg)
    return float(np.mean(masses)) if masses else None


def hanging(
    context: Context, window_s: float, least_kg: float
) -> Generator[None, None, Weight | None]:
    """Weigh what is in the jaws until it is known whether it is more than a mass.

    A machine on its legs sways under a load that it takes on or stops, and a load that sways
    presses by a fifth more or less than it weighs. The weighing ends once the mass is two standard
    deviations from the one that it is compared with, or known to 1.5 % of that; in any case after
    2.5 s, a swing of the slowest sway, with the standard deviation that is left.

    Args:
        context: The leaf's view of the mission.
        window_s: Time for which it is weighed at least [s].
        least_kg: Mass that it is compared with [kg].

    Returns:
        The mass, and how far sway and noise leave it open; None if none is told.
    """
    began_s, told = context.now_s(), list[tuple[float, float]]()
    while True:
        yield None
        now_s, mass_kg = context.now_s(), context.payload_kg()
        if mass_kg is not None:
            told.append((now_s, mass_kg))
        if now_s - began_s < window_s:
            continue
        if not told:
            return None
        weight = Weight(*level(*np.array(told).T))
        is_sure = abs(weight.mass_kg - least_kg) > SURE * weight.std_kg
        if is_sure or weight.std_kg < _KNOWN * least_kg or now_s - began_s >= _LONGEST_S:
            return weight


def least_kg(stone: Stone, stones: Sequence[Stone], share: float = LEAST_SHARE) -> float:
    """Return the mass below which the ground carries a part of a stone [kg].

    It is two standard deviations below the mass that was weighed before: those of the difference of
    two weights, for this one is as uncertain as that one. Of a stone that was not weighed, it is a
    share of the mass that its volume tells: two standard deviations below that of the stones of the
    site that were weighed and placed.

    Args:
        stone: The stone.
        stones: All known ones.
        share: The share while none was weighed.
    """
    if stone.weight is not None:
        return stone.mass_kg - SURE * float(np.sqrt(2)) * stone.weight.std_kg
    weighed = [one for one in stones if one.weight is not None and one.state is StoneState.PLACED]
    if weighed:
        share = _least_of_next([one.mass_kg / one.mass_by_volume_kg for one in weighed])
    return share * stone.mass_by_volume_kg


def agree(weights: Sequence[Weight]) -> bool:
    """Return whether weights may be of one mass: their spread is what 99 % of such weights have."""
    from executive.geometry import chi_square  # scipy: reading a mission does not wait for it

    masses_kg = np.array([one.mass_kg for one in weights])
    precision = 1.0 / np.maximum([one.std_kg for one in weights], _LEAST_STD_KG) ** 2
    mean_kg = float((precision * masses_kg).sum() / precision.sum())
    spread = float((precision * (masses_kg - mean_kg) ** 2).sum())
    return spread <= chi_square.quantile(_AGREE, len(weights) - 1)


def _least_of_next(shares: Sequence[float]) -> float:
    """Return the share that the next stone of a site weighs at least, given those of some.

    A share above one is that of a stone whose volume is not known whole, and tells nothing.
    """
    known, n = np.minimum(shares, 1.0), len(shares)
    about = ((known - known.mean()) ** 2).sum()
    variance = (_ONE_SITE_STONES * _ONE_SITE**2 + about) / (_ONE_SITE_STONES + n - 1)
    return float(known.mean() - SURE * np.sqrt(variance * (1 + 1 / n)))
