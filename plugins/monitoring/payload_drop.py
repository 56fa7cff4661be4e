"""A dropped stone, detected by a loss of weight in the efforts of the arm."""

from collections import deque
from dataclasses import dataclass, field

import numpy as np
from executive_plugins.monitoring.payload_scale import PayloadScale
from executive_plugins.monitoring.settings import PayloadDropSettings
from executive_plugins.monitoring.signal_filters import LowPass

from executive.interfaces.monitoring import Monitor
from executive.machine.machine import Machine
from executive.messages.joints import JointSample
from executive.messages.verdict import Trouble, Verdict

_VELOCITY_S = 0.2  # time constant of the velocities from which accelerations are derived
_SINKING_M_S = 0.02  # downward speed of the grasp centre that counts as sinking
_PRESSING = 0.2  # share of the carried mass; less than its negative means that the arm presses down


@dataclass(eq=False)
class _Hold:
    """State of one hold."""

    mass: LowPass
    velocity: LowPass = field(default_factory=lambda: LowPass(_VELOCITY_S))
    carried_kg: float = 0.0
    carried_s: float = 0.0  # last time at which the weight was present
    # (stamp [s], opening of the jaws [m]) while the weight was present.
    openings: deque[tuple[float, float]] = field(default_factory=deque)
    sinking_s: float = -np.inf  # last time at which the gripper moved down
    lost_s: float | None = None  # time at which the weight was lost


class PayloadDrop(Monitor):
    """Estimates the held mass, and reports when most of it is suddenly gone.

    The method is that of Mascaro 2020, Sec. 6.3. Samples during strong accelerations are skipped,
    since the estimate assumes an arm at rest. An addition of ours: the ground also takes the weight
    of a stone that is set down. A loss during or soon after a downward motion therefore counts only
    if the jaws have closed as well.
    """

    Settings = PayloadDropSettings

    def __init__(self, settings: PayloadDropSettings, machine: Machine) -> None:
        self._settings = settings
        self._machine = machine
        self._hold: _Hold | None = None

    def start(self) -> None:
        self._scale = PayloadScale(self._machine)

    def payload_kg(self, sample: JointSample) -> float | None:
        return self._scale.weigh(sample)

    def begin_hold(self) -> None:
        self._hold = _Hold(LowPass(self._settings.smoothing))

    def end_hold(self) -> None:
        self._hold = None

    def update(self, sample: JointSample) -> Verdict | None:
        hold = self._hold
        if hold is None or not self._is_steady(hold, sample):
            return None
        now_s = sample.stamp_s
        if self._scale.rise_m_s(sample) < -_SINKING_M_S:
            hold.sinking_s = now_s
        smoothed, _ = hold.mass.add(now_s, np.array([self._scale.weigh(sample)]))
        mass_kg = float(smoothed[0])
        opening_m = self._machine.gripper.opening_m(sample.of(self._machine.jaw.name)[0])
        self._follow_weight(hold, now_s, mass_kg, opening_m)
        if (
            hold.lost_s is None
            or now_s - hold.lost_s < self._settings.confirm
            or not self._is_drop(hold, opening_m)
        ):
            return None
        self._hold = None
        return Verdict(
            now_s,
            "payload_drop",
            Trouble.DROP,
            f"{mass_kg:.0f} kg left of {hold.carried_kg:.0f} kg",
        )

    def _is_steady(self, hold: _Hold, sample: JointSample) -> bool:
        _, rate = hold.velocity.add(
            sample.stamp_s, np.array([sample.of(name)[1] for name in self._machine.arm_names])
        )
        return bool((np.abs(rate) <= self._settings.steady * self._machine.max_acceleration).all())

    def _follow_weight(self, hold: _Hold, now_s: float, mass_kg: float, opening_m: float) -> None:
        """Update the largest weight, when most of it was lost, and the openings before that."""
        settings = self._settings
        if mass_kg > (1 - settings.loss / 2) * hold.carried_kg:
            hold.carried_kg, hold.carried_s = max(hold.carried_kg, mass_kg), now_s
            hold.openings.append((now_s, opening_m))
            while now_s - hold.openings[0][0] > settings.sudden:
                hold.openings.popleft()
        if mass_kg < -_PRESSING * hold.carried_kg:
            # A negative mass: the arm presses on the ground, which carries the stone.
            hold.sinking_s = now_s
        is_lost = (
            hold.carried_kg >= settings.carried and mass_kg < (1 - settings.loss) * hold.carried_kg
        )
        if not is_lost:
            hold.lost_s = None
        elif hold.lost_s is None:
            hold.lost_s = now_s

    def _is_drop(self, hold: _Hold, opening_m: float) -> bool:
        lost_s = np.inf if hold.lost_s is None else hold.lost_s
        is_sudden = lost_s - hold.carried_s < self._settings.sudden
        may_be_supported = lost_s - hold.sinking_s < self._settings.touch_down
        widest_m = max((opening for _, opening in hold.openings), default=opening_m)
        return is_sudden and (
            not may_be_supported or widest_m - opening_m > self._settings.jaw_closing
        )
