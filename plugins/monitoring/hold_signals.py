"""The signals of a hold, window by window, with standard deviations from the sensor's noise."""

from dataclasses import dataclass, field

import numpy as np
from executive_plugins.monitoring.carried_mass import CarriedMass
from executive_plugins.monitoring.grip_state import Signal, Signals
from executive_plugins.monitoring.jaw_motion import JawMotion
from executive_plugins.monitoring.payload_scale import PayloadScale, encoders_of
from executive_plugins.monitoring.settings import HoldStateSettings

from executive.arrays import Float
from executive.machine.machine import Machine
from executive.messages.ground_below import GroundBelow
from executive.messages.joints import JointSample
from executive.messages.weight import Weight

WINDOW_S = 0.1  # two windows in a row show a fall well within half a second
_SURE = 5.0  # standard deviations from which a mean is more than noise
_FORCE_STD = 0.05  # of the force, as a share; the servo of the jaws varies by less
# After a downward motion the ground may carry the stone for so long: what stands with a half of its
# weight on the arm may leave it within that time.
_STOOD_S = 3.0
# A stone that is farther above what was seen below it is carried by nothing: its underside, which
# nobody has seen, was up to 13 cm lower than its model, and the map is some 2 cm off.
_CLEAR_M = 0.2
_PRESSING = -0.2  # share of the weight below which the arm may be pressed on the ground
_STANDS = 0.5  # share of the weight below which the ground carries it
_UNKNOWN = Signal(float("nan"), 1.0)


@dataclass(frozen=True, slots=True)
class HoldWindow:
    """What the samples of one window say.

    Attributes:
        signals: The signals for the filter.
        mass_kg: Mass in the jaws [kg].
        mass_std_kg: Its standard deviation by the noise, and by the motion of the arm [kg].
        opening_m: Distance of the tips [m].
        held_m: Distance of the tips at the start of the hold, or after the lift [m].
    """

    signals: Signals
    mass_kg: float
    mass_std_kg: float
    opening_m: float
    held_m: float


@dataclass(eq=False)
class _Samples:
    """The samples of one window: stamps [s], masses [kg], forces [N·m], openings [m], velocities
    of the arm's joints, and vertical speeds of the gripper [m/s].
    """

    stamps_s: list[float] = field(default_factory=list)
    masses_kg: list[float] = field(default_factory=list)
    forces: list[float] = field(default_factory=list)
    openings_m: list[float] = field(default_factory=list)
    velocities: list[Float] = field(default_factory=list)
    rises_m_s: list[float] = field(default_factory=list)


class HoldSignals:
    """Collects the samples of one hold, and returns its signals once a window is full."""

    def __init__(self, settings: HoldStateSettings, machine: Machine, scale: PayloadScale) -> None:
        self._machine, self._scale = machine, scale
        sensor = encoders_of(machine)
        self._velocity_std = sensor.velocity_noise
        self._force_std = sensor.effort_noise * machine.jaw.max_effort
        # Both tips move by their radius times the angle.
        self._opening_std_m = 2 * machine.gripper.tip_radius_m * sensor.angle_noise_rad
        self._window, self._newest_s = _Samples(), -np.inf
        self._velocity: Float | None = None  # mean of the window before
        self._mass, self._jaws = CarriedMass(), JawMotion(settings)
        self._closed_m = settings.empty
        self._force = 0.0  # largest mean so far
        self._sank_s = -np.inf
        self._may_have_stood = False  # in the window before
        self.below: GroundBelow | None = None  # what may carry the stone, where that is known
        self.has_slipped = False  # a slip was reported

    @property
    def weight(self) -> Weight | None:
        """Mass of the stone as weighed so far; None while nothing is carried."""
        return self._mass.weight

    def begin_carry(self) -> None:
        """Take the stone as settled in the jaws, and free of the ground, from now on."""
        self._jaws.settle()
        self._mass = CarriedMass()  # what tears a stone off the ground is no weight

    def add(self, sample: JointSample) -> HoldWindow | None:
        """Take one sample; return the window before it, if that is full."""
        if sample.stamp_s <= self._newest_s:
            return None
        self._newest_s, full = sample.stamp_s, None
        window = self._window
        if window.stamps_s and sample.stamp_s - window.stamps_s[0] > WINDOW_S - 1e-9:
            full, self._window = self._told(window), _Samples()
        self._collect(sample)
        return full

    def _collect(self, sample: JointSample) -> None:
        position, _, effort = sample.of(self._machine.jaw.name)
        self._q, self._jaw_rad, window = sample.position[:-1], position, self._window
        window.stamps_s.append(sample.stamp_s)
        window.masses_kg.append(self._scale.weigh(sample))
        window.forces.append(-effort)  # a negative effort closes
        window.openings_m.append(self._machine.gripper.opening_m(position))
        window.velocities.append(sample.velocity[:-1])
        window.rises_m_s.append(self._scale.rise_m_s(sample))

    def _told(self, window: _Samples) -> HoldWindow:
        now_s, root = window.stamps_s[-1], np.sqrt(len(window.stamps_s))
        opening_m, mass_kg = float(np.mean(window.openings_m)), float(np.mean(window.masses_kg))
        velocity: Float = np.mean(window.velocities, axis=0)
        is_moving = np.abs(velocity) > _SURE * self._velocity_std / root
        acceleration = self._acceleration(velocity)
        q_jaw = np.append(self._q, self._jaw_rad)
        moving_kg = self._scale.moving_kg(q_jaw, acceleration, is_moving)
        mass_std_kg = float(np.hypot(self._scale.noise_kg(self._q) / root, moving_kg))
        weight = self._mass.take(
            mass_kg,
            mass_std_kg,
            self._scale.shaken_share(self._q, acceleration),
            self._scale.lever_share(self._q),
            self._may_have_stood,
        )
        self._may_have_stood = self._may_stand(window, weight)
        std_m = self._opening_std_m / root * np.sqrt(2)  # of a difference of two openings
        closed, widened = self._jaws.take(now_s, opening_m, std_m, bool(is_moving.any()))
        signals = Signals(
            weight,
            self._pressing(window),
            closed,
            widened,
            self._jaws.forced(std_m),
            self._may_have_stood,
            self._jaws.has_settled,
            self.has_slipped,
        )
        return HoldWindow(signals, mass_kg, mass_std_kg, opening_m, self._jaws.held_m)

    def _acceleration(self, velocity: Float) -> Float:
        """Return the acceleration of the arm's joints, from two mean velocities."""
        before = velocity if self._velocity is None else self._velocity
        self._velocity = velocity
        return np.asarray((velocity - before) / WINDOW_S)

    def _pressing(self, window: _Samples) -> Signal:
        """Return the force of the jaws as a share of the largest so far, if it is measured.

        Closed jaws press on each other, whatever lies within them.
        """
        if self._jaws.held_m < self._closed_m:
            return _UNKNOWN
        force, noise = float(np.mean(window.forces)), self._force_std / np.sqrt(len(window.forces))
        self._force = max(self._force, force)
        if self._force <= _SURE * self._force_std:
            return _UNKNOWN
        return Signal(force / self._force, float(np.hypot(noise / self._force, _FORCE_STD)))

    def _may_stand(self, window: _Samples, weight: Signal) -> bool:
        """Return whether something may carry the stone.

        That is so if the gripper has sunk recently, or presses on what is below it, and never where
        the stone is known to be far above all that was seen below it. One that has slipped hangs
        lower than its model says, by how much is not known.
        """
        if self.below is not None and not self.has_slipped:
            clearance_m = self.below.clearance_m(self._scale.gripper(self._q))
            if clearance_m > _CLEAR_M:
                self._sank_s = -np.inf
                return False
        rises, now_s = window.rises_m_s, window.stamps_s[-1]
        spread = float(np.std(rises)) / np.sqrt(len(rises))
        noise = self._scale.rise_noise_m_s(self._q, self._velocity_std) / np.sqrt(len(rises))
        if np.mean(rises) < -_SURE * max(spread, noise) or weight.value < _PRESSING:
            self._sank_s = now_s
        may_stand = now_s - self._sank_s < _STOOD_S
        if may_stand and weight.value < _STANDS:
            self._sank_s = now_s  # it stands for as long as its weight is not on the arm
        return may_stand
