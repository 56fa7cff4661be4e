"""The chance that an attempt places its stone, after what came of the attempts before it.

Rehearsed lifts tell how often a grasp holds under the contacts that are assumed. Sites differ in
what no rehearsal knows: friction, soil, the machine. So the log odds of an attempt are a line over
those of its rehearsals, and an offset of the site that is common to all its attempts: a logistic
regression with a random intercept (Gelman and Hill 2007, Sec. 14.2). The offset is learned from the
attempts that have ended; before the first one it is that of any site.

The three numbers are a maximum of the likelihood over 687 attempts, in the order of time, of 71
missions with generated stones and scans, on a welded base and on legs: 528 attempts in the world
`nominal`, 80 in `harsh`, 72 in `wet` and 7 in `kind`. An attempt in which the stone is gripped anew
after a slip, and placed, is a success.
"""

from collections.abc import Sequence
from math import log

import numpy as np

from executive.arrays import Float

_INTERCEPT, _SLOPE = 1.35, 0.62
_SPREAD = 1.15  # standard deviation of the offsets of sites, in log odds
_LEAST = 0.02  # a rate is nowhere nearer to 0 or 1: few lifts cannot tell more
_OFFSETS: Float = _SPREAD * np.linspace(-4.0, 4.0, 81)
_PRIOR: Float = np.exp(-0.5 * np.linspace(-4.0, 4.0, 81) ** 2)


def expected_success(hold_rate: float, past: Sequence[tuple[float, bool]]) -> float:
    """Return the chance that an attempt places its stone.

    Args:
        hold_rate: The share of lifts with its grasp that are expected to hold, 0 to 1.
        past: The same of each attempt that has ended on the site, and whether it placed its stone.
    """
    belief = _PRIOR / _PRIOR.sum()
    for rate, has_placed in past:
        chance = _chance(rate)
        belief = belief * (chance if has_placed else 1.0 - chance)
        belief = belief / belief.sum()  # a product of thousands of chances would vanish
    return float(_chance(hold_rate) @ belief)


def _chance(hold_rate: float) -> Float:
    """Return the chance of success by the offset of the site."""
    rate = min(max(hold_rate, _LEAST), 1.0 - _LEAST)
    return np.asarray(
        1.0 / (1.0 + np.exp(-_INTERCEPT - _SLOPE * log(rate / (1.0 - rate)) - _OFFSETS))
    )
