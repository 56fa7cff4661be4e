"""The state of a grip, and how likely each state is, from signals with standard deviations."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from executive.arrays import Float
from executive.machine.gravity import GRAVITY_M_S2

_HALF = 0.5  # of the weight, or of the force: nearer to all of it than to nothing
# Of the weight of a stone that only the jaws can carry. A stone that slides out of them hangs on
# their friction: with less than this share it is 0.3 m on, and lost, within half a second (from
# s = (1 − w) g t² / 2).
_BORNE = 1 - 2 * 0.3 / (GRAVITY_M_S2 * 0.5**2)
_NOTHING = 0.2  # share of the force below which the jaws bear on nothing
# Slips. A stone that seats itself in a lift has forced jaws apart by less than two; once it hangs,
# nothing but a stone that slides or turns does.
APART, _APART_HANGING = 4.0, 1.0
_CREEP = 0.2  # share of the slip that counts as trouble, from which closing is creep
# Share of the weight below which the arm presses on what is under it: an arm that has lost its load
# swings about zero, by no more than that load, for its drives damp it.
_PRESSED = -1.0
# −2 ln of the probability that what has not sunk meets the ground: a level way over rising ground.
_UNSUNK = -2 * float(np.log(1e-3))
_SWITCH = 1e-3  # probability that a grip changes to another given state between two windows


class GripState(StrEnum):
    """What a held stone does."""

    FIRM = "firm"
    CREEPING = "creeping"  # it gives way by less than counts as slip
    SLIPPING = "slipping"
    OPENING = "opening"  # the jaws press no longer, or are forced apart
    SLID_DOWN = "slid onto the ground"  # the ground carries it, and the jaws have closed on it
    LOST = "lost"  # its weight is gone, and the jaws do not bear on it
    # The ground carries it, and the jaws still bear on it; or the arm is pressed onto it.
    TOUCHING_GROUND = "touching ground"


@dataclass(frozen=True, slots=True)
class Signal:
    """A measured value with its standard deviation; a NaN was not measured."""

    value: float
    std: float

    @property
    def is_unknown(self) -> bool:
        """Whether it was not measured."""
        return bool(np.isnan(self.value))

    def off(self, low: float, high: float) -> float:
        """Return the squared distance from an interval in standard deviations; 0 if unknown."""
        distance = self.value - min(max(self.value, low), high)
        return 0.0 if self.is_unknown else (distance / self.std) ** 2


@dataclass(frozen=True, slots=True)
class Signals:
    """The signals of one window of samples.

    Attributes:
        weight: Mass in the jaws as a share of the carried mass.
        force: Force of the jaws as a share of that at the grasp.
        closed: Closing of the jaws as a share of what counts as slip.
        widened: Opening of the jaws as a share of the same.
        forced: Opening within a moment, the largest of late, as a share of half of the same.
        may_stand: Whether the gripper has sunk or presses, so that the ground may carry the stone.
        has_settled: Whether the stone was found to hang, or has had the time to settle in the jaws.
        has_slipped: Whether it has slipped since, so that the ground may carry any part of it.
    """

    weight: Signal
    force: Signal
    closed: Signal
    widened: Signal
    forced: Signal
    may_stand: bool
    has_settled: bool = False
    has_slipped: bool = False


class GripFilter:
    """A discrete Bayes filter over the states of a grip.

    A state is a region of the signals, such as: the weight is there, the force is there, the jaws
    are where they were. Its likelihood is that of the nearest point of the region, so that
    −2 ln p is χ² distributed while the state lasts (generalised likelihood ratio: Van Trees 1968,
    Sec. 2.5). Ours, not the paper's, which gives no method.
    """

    def __init__(self) -> None:
        self._states = tuple(GripState)
        self._p = np.full(len(self._states), _SWITCH)
        self._p[0] = 1 - _SWITCH * (len(self._states) - 1)

    def update(self, signals: Signals) -> Mapping[GripState, float]:
        """Take one window; return the probability of each state."""
        chi2 = _chi2(signals)
        prior = (1 - _SWITCH * len(self._states)) * self._p + _SWITCH * self._p.sum()
        log_p = np.log(prior) - 0.5 * np.array([chi2[state] for state in self._states])
        p: Float = np.exp(log_p - log_p.max())
        self._p = p / p.sum()
        return dict(zip(self._states, (float(one) for one in self._p), strict=True))


def _chi2(s: Signals) -> dict[GripState, float]:
    """Return the squared distance of the signals from the region of each state."""
    inf = np.inf
    # A stone that was not found to hang may stand, though the gripper has not sunk.
    may_stand = s.may_stand or not s.has_settled
    borne = _HALF if may_stand or s.has_slipped else _BORNE
    carried, gone = s.weight.off(borne, inf), s.weight.off(-inf, borne)
    hanging = s.weight.off(_PRESSED, inf)
    pressed = inf if s.weight.is_unknown else s.weight.off(-inf, _PRESSED)
    unmoved, narrow = s.closed.off(-inf, 1.0), s.closed.off(1.0, inf)
    held, slid = s.closed.off(-inf, APART), s.closed.off(APART, inf)
    together, apart = s.widened.off(-inf, APART), s.widened.off(APART, inf)
    widest = _APART_HANGING if s.has_settled else APART
    # What comes down on the ground may force jaws apart at once, too.
    forced = inf if may_stand else s.forced.off(1.0, inf)
    calm = 0.0 if may_stand else s.forced.off(-inf, 1.0)
    pressing = s.force.off(_HALF, inf) + s.widened.off(-inf, widest) + calm
    bears = s.force.off(_NOTHING, inf) + together
    wide = min(s.widened.off(widest, inf), forced)
    weak = min(s.force.off(-inf, _HALF), wide)
    slack = min(s.force.off(-inf, _NOTHING), apart)
    standing = 0.0 if may_stand else _UNSUNK
    # Jaws press on for some tenths of a second on a stone that slides out of them: their force
    # tells a fall from a stone that stands only where it may stand.
    fallen = gone + (slack if may_stand else 0.0)
    if s.force.is_unknown:  # then the jaws' motion, and whether the gripper has sunk, have to tell
        weak = wide
        slack = min(narrow, apart) if s.may_stand else 0.0
        standing = 0.0 if s.may_stand else inf
        fallen = gone + slack
    down = min(gone + bears + standing, pressed)
    return {
        GripState.FIRM: carried + pressing + s.closed.off(-inf, _CREEP),
        GripState.CREEPING: carried + pressing + s.closed.off(_CREEP, 1.0),
        GripState.SLIPPING: carried + bears + narrow,
        GripState.OPENING: carried + unmoved + weak,
        # A stone that has fallen pulls at nothing; what pushes the arm up is below the gripper.
        GripState.LOST: inf if s.weight.is_unknown else hanging + min(fallen, narrow + slack),
        GripState.SLID_DOWN: slid + down,
        GripState.TOUCHING_GROUND: held + down,
    }
