"""The mass of a carried stone, from the windows of a hold."""

import numpy as np
from executive_plugins.monitoring.grip_state import Signal

from executive.messages.weight import Weight

_CARRIED = 0.5  # share of the mass from which the whole stone counts as carried
_SURE = 5.0  # standard deviations by which a carried mass differs from nothing
# A stone that slides and is caught jerks at the arm for two or three windows; what the ground
# carried until now hangs for good.
_LASTING = 5
_MEDIAN = 1.25  # standard deviation of a median over that of a mean, of normal values


class CarriedMass:
    """The weighted median of the masses of those windows in which the stone is carried.

    A window in which something below may carry a part of the stone is none of them: set down
    slowly, it stands with a part of its weight for longer than it was weighed at rest. A median,
    because the ground carries a part at the begin of a lift, too.
    """

    def __init__(self) -> None:
        self._windows: list[tuple[float, float]] = []  # mass and its standard deviation [kg]
        self._heavier = 0  # for how many windows in a row more hangs than was weighed
        self._lever_share = 0.0
        self.weight: Weight | None = None  # the mass so far; None while it is not above noise

    def take(
        self, mass_kg: float, noise_kg: float, moving: float, lever: float, may_stand: bool
    ) -> Signal:
        """Take the mass of a window, and return it as a share of the carried mass.

        Args:
            mass_kg: Mean over the window.
            noise_kg: Standard deviation of that mean by the noise of the efforts.
            moving: Standard deviation by the acceleration, as a share of the mass.
            lever: Standard deviation by where the stone is in the jaws, as a share of the mass;
                it is the same in all windows.
            may_stand: Whether something below may carry the stone: the window weighs nothing then.

        Returns:
            The share; unknown while no stone is carried.
        """
        before = self.weight
        std_kg = float(np.hypot(noise_kg, moving * max(mass_kg, 0.0)))
        above_kg = mass_kg - (before.mass_kg if before else mass_kg)
        is_heavier = not may_stand and above_kg > _SURE * np.hypot(std_kg, lever * mass_kg)
        self._heavier = self._heavier + 1 if is_heavier else 0
        if self._heavier == _LASTING:
            del self._windows[: 1 - _LASTING]  # the ground carried a part of it until then
        if not may_stand and mass_kg > (_CARRIED * before.mass_kg if before else 0.0):
            self._windows.append((mass_kg, std_kg))
            self._lever_share = lever
            self.weight = self._median()
        known = before or self.weight
        if known is None:
            return Signal(float("nan"), 1.0)
        total_kg = float(np.hypot(noise_kg, (moving + lever) * known.mass_kg))
        std = float(np.hypot(total_kg, known.std_kg)) / known.mass_kg
        return Signal(mass_kg / known.mass_kg, std)

    def _median(self) -> Weight | None:
        masses, stds = np.array(sorted(self._windows)).T
        information = np.cumsum(stds**-2)
        mass_kg = float(masses[np.searchsorted(information, information[-1] / 2)])
        random_kg = _MEDIAN / np.sqrt(information[-1])
        std_kg = float(np.hypot(random_kg, self._lever_share * mass_kg))
        return Weight(mass_kg, std_kg) if mass_kg > _SURE * std_kg else None
