"""Fixes that were refused, from which a filter begins anew once they explain the motion."""

import numpy as np
from executive_plugins.estimation.gate.innovation_scale import LARGEST_SCALE
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial
from executive_plugins.estimation.start.found import Found
from executive_plugins.estimation.start.settings import WindowStartSettings
from executive_plugins.estimation.start.window_start import WindowStart

TRUSTED = 3  # fixes in a row within the gate that end a doubt about the state


class RefusedFixes:
    """A window of fixes and samples since the first fix that was refused.

    Fixes that contradict the filter for so long, but not each other, are more likely right.
    """

    def __init__(
        self,
        settings: WindowStartSettings,
        noise: InertialNoise,
        clock_std_s: float,
        after_s: float,
    ) -> None:
        """Begin without a refusal.

        Args:
            settings: Of the window.
            noise: Noise of the inertial sensor.
            clock_std_s: Standard deviation of the receiver's clock [s].
            after_s: Time of refused fixes after which the estimate begins anew from them [s].
        """
        self._settings, self._noise, self._clock_std_s = settings, noise, clock_std_s
        self._after_s = after_s
        self.forget()

    def forget(self) -> None:
        """Take that fixes agree with the filter again."""
        self._window: WindowStart | None = None
        self._begun_s, self._used_in_row = np.inf, 0

    @property
    def are_awaited(self) -> bool:
        """Whether a fix was refused, and fixes may still explain the motion by themselves."""
        return self._window is not None

    def add_fix(self, fix: Fix) -> None:
        """Add a fix as it arrives."""
        if self._window is not None:
            self._window.add_fix(fix)

    def use(self, count: int) -> None:
        """Take that the filter has used some fixes in a row."""
        for _ in range(count):
            self._used_in_row += 1
            if self._used_in_row >= TRUSTED:
                self.forget()

    def refuse(self, now_s: float) -> bool:
        """Take that the filter has refused a fix [s]; return whether one was before."""
        self._used_in_row = 0
        if self._window is not None:
            return True
        self._window = WindowStart(self._settings.of_doubt(), self._noise, self._clock_std_s)
        self._begun_s = now_s
        return False

    def add_sample(self, sample: Inertial) -> Found | None:
        """Add a sample; return the state that the refused fixes tell once it refutes the filter.

        It does not if the filter agrees with the newest fix again, nor if its own fit is so bad
        that the window holds good and wrong fixes.
        """
        if self._window is None:
            return None
        self._window.add_sample(sample)
        if sample.stamp_s - self._begun_s < self._after_s:
            return None
        found = self._window.state()
        if found is None or not found.has_heading or self._used_in_row:
            return None
        return found if found.fix_scale < LARGEST_SCALE else None
