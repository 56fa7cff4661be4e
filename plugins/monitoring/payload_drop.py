"""A dropped stone, seen by the arm's efforts: the weight is gone."""

from collections import deque
from dataclasses import dataclass, field

import numpy as np
from executive_plugins.monitoring.payload_scale import PayloadScale
from executive_plugins.monitoring.signal_filters import LowPass
from pydantic import Field

from executive.config import Kilograms, Meters, Seconds, Settings
from executive.interfaces.monitoring import Monitor
from executive.machine.machine import Machine
from executive.messages.joints import JointSample
from executive.messages.verdict import Trouble, Verdict

_VELOCITY_S = 0.2  # smoothing of measured velocities, to tell accelerations
_SINKING_M_S = 0.02
_PRESSING = 0.2  # share of the carried mass


class PayloadDropSettings(Settings):
    """When a loss of weight is a drop."""

    smoothing: Seconds = Field(
        0.3, gt=0, le=5, description="Time constant of the weighed mass [s]."
    )
    carried: Kilograms = Field(
        250.0, gt=0, description="Mass from which something counts as carried [kg]."
    )
    loss: float = Field(
        0.5, gt=0, lt=1, description="Share of the carried mass whose loss is a drop."
    )
    sudden: Seconds = Field(3.0, gt=0, le=60, description="A loss within this time is sudden [s].")
    confirm: Seconds = Field(
        0.4, ge=0, le=5, description="How long the loss must last before it is told [s]."
    )
    steady: float = Field(
        0.6,
        gt=0,
        le=5,
        description="Share of the acceleration limits up to which weighing is valid.",
    )
    touch_down: Seconds = Field(
        3.0, ge=0, le=60, description="After sinking, a loss may be the ground's support [s]."
    )
    jaw_closing: Meters = Field(
        0.05, gt=0, le=1, description="Closing of the tips that tells a drop from support [m]."
    )


@dataclass(eq=False)
class _Hold:
    """What is remembered of one hold."""

    mass: LowPass
    velocity: LowPass = field(default_factory=lambda: LowPass(_VELOCITY_S))
    carried_kg: float = 0.0
    carried_s: float = 0.0  # when the weight was last there
    openings: deque[tuple[float, float]] = field(
        default_factory=deque
    )  # (stamp, jaws' opening) while it was there
    sinking_s: float = -np.inf  # when the gripper last went down
    lost_s: float | None = None  # since when the weight is gone


class PayloadDrop(Monitor):
    """Weighs what is held and tells when most of it is suddenly gone (Mascaro 2020, Sec. 6.3).

    Samples during strong accelerations are left out: the weight is that of a machine at rest. Our
    own addition: a stone that is set down loses its weight to the ground, too, so that a loss in or
    soon after a downward motion counts only if the jaws have closed as well.
    """

    Settings = PayloadDropSettings

    def __init__(self, settings: PayloadDropSettings, machine: Machine) -> None:
        self._settings = settings
        self._machine = machine
        self._hold: _Hold | None = None

    def start(self) -> None:
        self._scale = PayloadScale(self._machine)

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
        """Note the largest weight, since when most of it is gone, and how the jaws stood before."""
        settings = self._settings
        if mass_kg > (1 - settings.loss / 2) * hold.carried_kg:
            hold.carried_kg, hold.carried_s = max(hold.carried_kg, mass_kg), now_s
            hold.openings.append((now_s, opening_m))
            while now_s - hold.openings[0][0] > settings.sudden:
                hold.openings.popleft()
        if mass_kg < -_PRESSING * hold.carried_kg:
            hold.sinking_s = (
                now_s  # less than nothing: the arm leans on the ground, on which the stone stands
            )
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
        may_stand = lost_s - hold.sinking_s < self._settings.touch_down
        widest_m = max((opening for _, opening in hold.openings), default=opening_m)
        return is_sudden and (not may_stand or widest_m - opening_m > self._settings.jaw_closing)
