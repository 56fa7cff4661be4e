"""Slip of a held stone, detected by the jaws' encoder.

The jaws keep pressing, so they close further when the stone gives way.
"""

from collections import deque
from dataclasses import dataclass, field

import numpy as np
from executive_plugins.monitoring.settings import JawSlipSettings
from executive_plugins.monitoring.signal_filters import RunningMedian

from executive.interfaces.monitoring import Monitor
from executive.machine.machine import Machine
from executive.messages.joints import JointSample
from executive.messages.verdict import Trouble, Verdict

_SMOOTHING_S = 0.2  # span of the median
_MOVING = 0.02  # ten times the noise of a measured velocity [rad/s] or [m/s]


@dataclass(eq=False)
class _Hold:
    """State of one hold."""

    median: RunningMedian = field(default_factory=lambda: RunningMedian(_SMOOTHING_S))
    # (stamp [s], smoothed opening [m]) over the window.
    openings: deque[tuple[float, float]] = field(default_factory=deque)
    first_m: float | None = None  # opening at the start, taken again once the stone has settled
    settled_s: float = np.inf  # time at which the stone will have settled in the lift
    has_settled: bool = False
    trouble_s: float | None = None  # time at which trouble began


class JawSlip(Monitor):
    """Compares the opening of the jaws with that of some seconds ago and of the start of the hold.

    The method is that of Mascaro 2020, Sec. 6.3, which gives no figures. Ours: the noise of the
    encoder is half a millimetre of opening. In 512 lifts by the simulated arm, 16 of 18 stones were
    held after the jaws had closed by 12–30 cm as the stone left the ground, 5 of 10 after 30–50 cm,
    and none after more; a settled stone gives way by 2 mm.
    """

    Settings = JawSlipSettings

    def __init__(self, settings: JawSlipSettings, machine: Machine) -> None:
        self._settings = settings
        self._machine = machine
        self._hold: _Hold | None = None

    def begin_hold(self) -> None:
        self._hold = _Hold()

    def end_hold(self) -> None:
        self._hold = None

    def update(self, sample: JointSample) -> Verdict | None:
        hold = self._hold
        if hold is None:
            return None
        opening_m = hold.median.add(sample.stamp_s, self._opening_m(sample))
        if opening_m is None:
            return None
        self._follow_lift(hold, sample)
        trouble = self._judge(hold, sample.stamp_s, opening_m)
        if trouble is None:
            hold.trouble_s = None
            return None
        hold.trouble_s = sample.stamp_s if hold.trouble_s is None else hold.trouble_s
        if sample.stamp_s - hold.trouble_s < self._settings.confirm:
            return None
        self._hold = None
        detail = f"jaws {opening_m:.3f} m open, {hold.first_m:.3f} m before"
        return Verdict(sample.stamp_s, "jaw_slip", trouble, detail)

    def _opening_m(self, sample: JointSample) -> float:
        return self._machine.gripper.opening_m(sample.of(self._machine.jaw.name)[0])

    def _follow_lift(self, hold: _Hold, sample: JointSample) -> None:
        """Note when the arm first moves; restart the comparison once the stone has settled."""
        is_moving = any(abs(sample.of(name)[1]) > _MOVING for name in self._machine.arm_names)
        if is_moving and hold.settled_s == np.inf:
            hold.settled_s = sample.stamp_s + self._settings.lift_settle
        if sample.stamp_s >= hold.settled_s and not hold.has_settled:
            hold.has_settled, hold.first_m = True, None
            hold.openings.clear()

    def _judge(self, hold: _Hold, now_s: float, opening_m: float) -> Trouble | None:
        settings = self._settings
        hold.first_m = opening_m if hold.first_m is None else hold.first_m
        hold.openings.append((now_s, opening_m))
        while now_s - hold.openings[0][0] > settings.window:
            hold.openings.popleft()
        if opening_m < settings.empty:
            return Trouble.EMPTY
        closed_m = max(opening for _, opening in hold.openings) - opening_m
        if not hold.has_settled:
            return Trouble.SLIP if hold.first_m - opening_m > settings.lift_slip else None
        is_slip = closed_m > settings.slip or hold.first_m - opening_m > settings.creep
        return Trouble.SLIP if is_slip else None
