"""The hold as an estimate: its state with probabilities, the stone's mass, and trouble as verdicts.

It uses the efforts of arm and jaws and the jaws' encoder.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from executive_plugins.monitoring.grip_state import APART, GripFilter, GripState
from executive_plugins.monitoring.hold_signals import WINDOW_S, HoldSignals, HoldWindow
from executive_plugins.monitoring.payload_scale import PayloadScale
from executive_plugins.monitoring.settings import HoldStateSettings

from executive.interfaces.monitoring import Monitor
from executive.machine.machine import Machine
from executive.messages.ground_below import GroundBelow
from executive.messages.joints import JointSample
from executive.messages.verdict import Trouble, Verdict
from executive.messages.weight import Weight

_TROUBLE = (GripState.LOST, GripState.OPENING, GripState.SLIPPING, GripState.SLID_DOWN)
_STANDING = (GripState.TOUCHING_GROUND, GripState.SLID_DOWN)
_SURE = 2.0  # standard deviations of a mass from which something hangs
# Times for which trouble must last. A fall begins as a slip or with opening jaws: those wait for
# what becomes of them, so that one event is reported once.
_FALL_S, _SLIP_S = 2 * WINDOW_S, 3 * WINDOW_S


@dataclass(eq=False)
class _Hold:
    """State of one hold."""

    signals: HoldSignals
    grip: GripFilter = field(default_factory=GripFilter)
    state: GripState = GripState.FIRM  # the likeliest trouble
    windows: int = 0  # for how many windows some trouble is sure
    standing: float = 0.0  # probability that the ground carries the stone


class HoldState(Monitor):
    """Estimates the state of the grip, and reports slips and falls with their evidence.

    The task is that of Mascaro 2020, Sec. 6.3; the method is ours (see `GripFilter`). A hold has at
    most one slip and one fall; a stone that falls at once has no slip.
    """

    Settings = HoldStateSettings
    name: ClassVar[str] = "hold_state"
    told: ClassVar[frozenset[Trouble]] = frozenset(Trouble)  # the kinds that are reported

    def __init__(self, settings: HoldStateSettings, machine: Machine) -> None:
        self._settings = settings
        self._machine = machine
        self._hold: _Hold | None = None
        self._weight: Weight | None = None
        self._is_carried = False

    def start(self) -> None:
        self._scale = PayloadScale(self._machine)

    def payload_kg(self, sample: JointSample) -> float | None:
        return self._scale.weigh(sample)

    def weight(self) -> Weight | None:
        return self._weight

    def is_carried(self) -> bool:
        return self._is_carried

    def standing(self) -> float | None:
        return None if self._hold is None or self._weight is None else self._hold.standing

    def begin_hold(self) -> None:
        self._weight, self._is_carried = None, False
        self._hold = _Hold(HoldSignals(self._settings, self._machine, self._scale))

    def begin_carry(self) -> None:
        if self._hold is not None:
            self._is_carried = True
            self._hold.signals.begin_carry()

    def carry_over(self, below: GroundBelow) -> None:
        if self._hold is not None:
            self._hold.signals.below = below

    def end_hold(self) -> None:
        self._hold = None

    def update(self, sample: JointSample) -> Verdict | None:
        hold = self._hold
        window = None if hold is None else hold.signals.add(sample)
        if hold is None or window is None:
            return None
        if not hold.signals.has_slipped:  # later, the ground may carry any part of it
            self._weight = hold.signals.weight or self._weight
        likely = hold.grip.update(window.signals)
        hold.standing = sum(likely[one] for one in _STANDING)
        trouble = self._trouble(hold, window, likely)
        if trouble is None or (trouble is Trouble.SLIP and hold.signals.has_slipped):
            return None
        hold.signals.has_slipped = True  # only a fall may follow
        if trouble is not Trouble.SLIP:
            self._hold = None
        if trouble not in self.told and not self._is_empty(window):
            return None
        return Verdict(sample.stamp_s, self.name, trouble, self._evidence(hold, window, likely))

    def _is_empty(self, window: HoldWindow) -> bool:
        """Return whether the jaws have closed on nothing.

        Those that were closed as the hold began, or as it was weighed, may hold a stone within
        them: it hangs there, or nothing does.
        """
        if window.opening_m >= self._settings.empty:
            return False
        hangs = self._weight is not None or window.mass_kg > _SURE * window.mass_std_kg
        return window.held_m >= self._settings.empty or not hangs

    def _trouble(
        self, hold: _Hold, window: HoldWindow, likely: Mapping[GripState, float]
    ) -> Trouble | None:
        """Return what is reported of this window, if anything."""
        sure = self._settings.probability
        state = max(_TROUBLE, key=lambda one: likely[one])
        is_empty = self._is_empty(window)
        # Kinds of trouble that cannot be told apart yet are trouble all the same.
        if sum(likely[one] for one in _TROUBLE) < sure and not is_empty:
            hold.windows = 0
            return None
        hold.windows += 1
        is_lost = is_empty or likely[GripState.LOST] >= sure
        hold.state = state
        lasting_s = _FALL_S if is_lost else _SLIP_S
        return self._kind(state, window) if hold.windows * WINDOW_S >= lasting_s - 1e-9 else None

    def _kind(self, state: GripState, window: HoldWindow) -> Trouble:
        if self._is_empty(window):
            return Trouble.EMPTY if self._weight is None else Trouble.DROP
        if state is GripState.LOST:
            return Trouble.DROP
        is_apart = window.signals.widened.value > APART
        return Trouble.DROP if state is GripState.OPENING and is_apart else Trouble.SLIP

    def _evidence(self, hold: _Hold, window: HoldWindow, likely: Mapping[GripState, float]) -> str:
        is_empty = self._is_empty(window)  # the angle alone tells that
        words = [
            "nothing is between the jaws"
            if is_empty and likely[hold.state] < self._settings.probability
            else f"{hold.state} (p = {likely[hold.state]:.2f})",
            f"jaws {window.opening_m:.3f} m open, {window.held_m:.3f} m before",
        ]
        if self._weight is not None:
            words.append(f"{window.mass_kg:.0f} kg left of {self._weight}")
        if not window.signals.force.is_unknown:
            words.append(f"pressing with {window.signals.force.value:.0%} of the force")
        return "; ".join(words)
