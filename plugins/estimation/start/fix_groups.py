"""Fixes of a window, thinned to a number of times without the loss of what they say together."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from executive_plugins.estimation.gate.measurements import Fix

# Over a group, the motion is taken as straight: an acceleration a bends it by a T² / 24 on average
# over the time T. A walker, a car and a flyer accelerate by about this.
_ACCELERATION_M_S2 = 5.0

Nodes = list[tuple[float, list[Fix]]]


def grouped(by_time: Mapping[float, Sequence[Fix]], most: int) -> Nodes:
    """Return at most so many times with their fixes, oldest first and evenly spaced.

    A chosen time has the mean of the fixes around it, as many as keep the error of the mean below
    its noise; the others are left out. Where there are few fixes, all stay as they are.

    Args:
        by_time: Fixes by time [s], oldest first.
        most: Largest number of times.
    """
    stamps = np.array(list(by_time))
    if len(stamps) <= most:
        return [(at_s, list(fixes)) for at_s, fixes in by_time.items()]
    wanted = np.linspace(stamps[0], stamps[-1], most)
    chosen = np.unique(np.abs(stamps[None, :] - wanted[:, None]).argmin(axis=1))
    half = _half_width(by_time[float(stamps[-1])][0], stamps, int(np.diff(chosen).min()))
    groups = []
    for i in chosen.tolist():
        reach = min(half, i, len(stamps) - 1 - i)
        near = [float(at_s) for at_s in stamps[i - reach : i + reach + 1]]
        groups.append((float(np.mean(near)), _means([by_time[at_s] for at_s in near])))
    return groups


def longest_straight_s(fix: Fix) -> float:
    """Return the time T over which a motion bends by less than a fix's noise, σ = a T² / 2 [s]."""
    std_m = float(np.sqrt(np.linalg.eigvalsh(fix.covariance)[0]))
    return float(np.sqrt(2.0 * std_m / _ACCELERATION_M_S2))


def _half_width(fix: Fix, stamps: np.ndarray, spacing: int) -> int:
    """Return how many fixes on each side of a chosen one are joined to it.

    From a T² / 24 = σ / √(T f) with the standard deviation σ of one fix and their rate f.
    """
    period_s = float(np.median(np.diff(stamps)))
    std_m = float(np.sqrt(np.linalg.eigvalsh(fix.covariance)[0]))
    span_s = (24.0 * std_m * np.sqrt(period_s) / _ACCELERATION_M_S2) ** 0.4
    return int(min(span_s / (2.0 * period_s), (spacing - 1) // 2))


def _means(near: Sequence[Sequence[Fix]]) -> list[Fix]:
    """Return the mean fix of each antenna that has one at every time of a group."""
    means = []
    for fix in near[len(near) // 2]:
        same = [one for fixes in near for one in fixes if one.antenna == fix.antenna]
        if len(same) < len(near):
            means.append(fix)
            continue
        means.append(
            replace(
                fix,
                stamp_s=float(np.mean([one.stamp_s for one in same])),
                p_map_antenna=np.mean([one.p_map_antenna for one in same], axis=0),
                covariance=np.mean([one.covariance for one in same], axis=0) / len(same),
            )
        )
    return means
