"""Weigh what is in the jaws, and the least that a stone which hangs free weighs."""

import math
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass

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
# What the ground bears of a stone changes as the stone is raised and tilts: by 8 % of it over 0.1 m
# with a middle 0.4 m high, 0.5 m beside its edge. Weights that differ by less are of a free stone.
# Two that are known to this share are told as such if they are equal.
_ALIKE, _ONE_SIDED = 0.05, 1.645  # share of the mass; quantile of 95 %
_KNOWN_WELL = 0.01
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

    The weighing ends once the mass is two standard deviations from the one that it is compared
    with, or known to 1.5 % of that.

    Args:
        context: The leaf's view of the mission.
        window_s: Time for which it is weighed at least [s].
        least_kg: Mass that it is compared with [kg].

    Returns:
        The mass, and how far sway and noise leave it open; None if none is told.
    """
    return (
        yield from _weighed(
            context,
            window_s,
            lambda weight: (
                abs(weight.mass_kg - least_kg) > SURE * weight.std_kg
                or weight.std_kg < _KNOWN * least_kg
            ),
        )
    )


def hanging_precisely(context: Context, window_s: float) -> Generator[None, None, Weight | None]:
    """Weigh what is in the jaws until it is known so well that it is told from a part of it."""
    return (
        yield from _weighed(
            context, window_s, lambda weight: weight.std_kg < _KNOWN_WELL * abs(weight.mass_kg)
        )
    )


def _weighed(
    context: Context, window_s: float, is_enough: Callable[[Weight], bool]
) -> Generator[None, None, Weight | None]:
    """Weigh what is in the jaws until it is known well enough; None if no mass is told.

    A machine on its legs sways under a load that it takes on or stops, and a load that sways
    presses by a fifth more or less than it weighs. The weighing ends in any case after 2.5 s, a
    swing of the slowest sway, with the standard deviation that is left.
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
        if is_enough(weight) or now_s - began_s >= _LONGEST_S:
            return weight


@dataclass(frozen=True, slots=True)
class Asked:
    """What a stone that hangs free weighs, by what is known of it.

    Attributes:
        least_kg: Mass below which the ground carries a part of it.
        sure_kg: Mass from which it hangs free; in between nothing is known.
    """

    least_kg: float
    sure_kg: float


def asked_of(stone: Stone, stones: Sequence[Stone], share: float = LEAST_SHARE) -> Asked:
    """Return which mass has to hang in the jaws before a stone is taken to hang free.

    Of a stone that was weighed before, two standard deviations less: those of the difference of
    two weights, for this one is as uncertain as that one. Of another one, a share of the mass that
    its volume tells is the least. It hangs free from one standard deviation below the mean of the
    site's stones that were weighed and placed, which five of six reach; the first one of a site
    from all that its volume tells.

    Args:
        stone: The stone.
        stones: All known ones.
        share: The least share of the mass by volume.
    """
    if stone.weight is not None:
        known_kg = stone.mass_kg - SURE * float(np.sqrt(2)) * stone.weight.std_kg
        return Asked(known_kg, known_kg)
    weighed = [one for one in stones if one.weight is not None and one.state is StoneState.PLACED]
    usual = _usual_share([one.mass_kg / one.mass_by_volume_kg for one in weighed])
    return Asked(share * stone.mass_by_volume_kg, max(share, usual) * stone.mass_by_volume_kg)


def are_equal(one: Weight, other: Weight) -> bool:
    """Return whether two weights differ by less than a part of them, with 95 % certainty.

    Source: D. Schuirmann, A comparison of the two one-sided tests procedure, 1987.
    """
    most_kg = _ALIKE * (one.mass_kg + other.mass_kg) / 2
    apart_kg = abs(one.mass_kg - other.mass_kg)
    return apart_kg + _ONE_SIDED * math.hypot(one.std_kg, other.std_kg) < most_kg


def _usual_share(shares: Sequence[float]) -> float:
    """Return the share that the next stone weighs at least in five of six cases, given some.

    A share above one is that of a stone whose volume is not known whole, and tells nothing.
    """
    if not shares:
        return 1.0
    known, n = np.minimum(shares, 1.0), len(shares)
    about = ((known - known.mean()) ** 2).sum()
    variance = (_ONE_SITE_STONES * _ONE_SITE**2 + about) / (_ONE_SITE_STONES + n - 1)
    return float(known.mean() - np.sqrt(variance * (1 + 1 / n)))
