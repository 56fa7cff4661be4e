"""The part that all estimators of a cabin share: checks of samples, first state, propagation."""

from abc import abstractmethod
from collections.abc import Mapping, Sequence

import numpy as np
from executive_plugins.estimation.cabin.aligning import Aligning
from executive_plugins.estimation.cabin.aligning_witness import AligningWitness
from executive_plugins.estimation.cabin.sensors import antennas_in_imu, cabin_imu
from executive_plugins.estimation.cabin.settings import CabinSettings
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.gate.stamp_gate import StampGate
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.state import Inertial
from executive_plugins.estimation.kalman.agreeing_clock import AgreeingClock
from executive_plugins.estimation.live.kernels import is_beyond_range
from executive_plugins.estimation.live.propagator import OUT_OF_RANGE, LivePropagator
from executive_plugins.estimation.start.chassis import ChassisRest, StandstillDetector, TurnJoint
from executive_plugins.estimation.start.chassis_level import ChassisLevel
from executive_plugins.estimation.start.chassis_sway import ChassisSway
from executive_plugins.estimation.start.first_state import FirstState
from executive_plugins.estimation.start.found import Found
from typing_extensions import Buffer

from executive.arrays import Float
from executive.geometry.geodesy import enu_from_geodetic
from executive.geometry.pose import inverse
from executive.interfaces.estimation import Estimator
from executive.interfaces.recorded_log import RecordedBody
from executive.machine.rig import Rig
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.status_change import StatusChange

INITIALISING, ALIGNING = "INITIALISING", "ALIGNING"
# An inertial stamp further ahead than this is accepted only if the next one is close to it. A
# smaller step is a gap.
_JUMP_S = 2.0
_STANDING_PERIOD_S = 0.1
# Spread of the angular velocity of a parked vehicle with its engine running [rad/s]; three times
# what was measured on a car. It replaces the machine's limit where the vehicle is unknown.
_IDLING_RAD_S = 0.15
# Largest squared Mahalanobis distance of a fix on an unknown body, whose fixes may scatter by 1.65
# times their stated standard deviation: 60 = 22 · 1.65², with 22 the default of the gates.
UNKNOWN_BODY_GATE = 60.0
# Clocks that nothing synchronises: delays of drivers and of a receiver's solution reach 0.2 s.
_UNKNOWN_CLOCK_S = 0.1
_AGREES = 0.5  # probability that an unknown clock agrees: nothing is known of which
_REPORT_PERIOD_S = 5.0  # between reports of what a start waits for


class CabinEstimator(Estimator):
    """Checks samples, finds the first state and reports the propagated state.

    Subclasses implement the correction by measurements.
    """

    def __init__(self, settings: CabinSettings, machine: Rig) -> None:
        self._cabin = settings
        self._machine = machine

    @classmethod
    def settings_for(cls, body: RecordedBody) -> Mapping[str, object]:
        default = cls.Settings.model_fields["imu"].default
        imu = default if default in body.imus else body.imus[0]
        known: dict[str, object] = {"imu": imu, "datum": body.datum}
        if not body.is_described:
            known["rest"] = {"max_rate_std_rad_s": _IDLING_RAD_S}
            known["clock_std_s"] = _UNKNOWN_CLOCK_S
            if body.clock_std_s is None:
                known["clock_agrees"] = _AGREES
        if body.clock_std_s is not None:
            known["clock_std_s"] = body.clock_std_s
        return known

    @property
    def imu(self) -> str:
        return self._cabin.imu

    @property
    def datum(self) -> tuple[float, float, float] | None:
        return self._cabin.datum

    @property
    def map_origin(self) -> tuple[float, float, float] | None:
        if self._datum is None:
            return None
        latitude_deg, longitude_deg, altitude_m = map(float, self._datum)
        return latitude_deg, longitude_deg, altitude_m

    def start(self) -> None:
        settings = self._cabin
        imu = cabin_imu(self._machine, settings.imu)
        self._noise = InertialNoise.of(imu, settings.noise_factor, settings.gravity_m_s2)
        self._T_imu_cabin = inverse(imu.T_link_sensor)
        self._antennas_imu = antennas_in_imu(self._machine, imu)
        self._stamp_gate = StampGate()
        self._turn = TurnJoint(self._machine)
        sway = ChassisSway.of(self._machine, settings.chassis_imu, settings.standing)
        self._standing = StandstillDetector(settings.standing, sway)
        self._datum: Float | None = None
        if settings.datum is not None:
            self._datum = np.array(settings.datum)
        self._status_changes: list[StatusChange] = []
        self._reported_s = -np.inf
        memory = self._shared_memory()
        self._propagator = LivePropagator(
            self._T_imu_cabin, self._turn, self._noise, settings.restart_after_s, memory
        )
        self._restart()

    @property
    def revision(self) -> int:  # type: ignore[override]
        return int(self._datum is not None)

    def keep(self) -> Mapping[str, Float]:
        """Return the map's origin: the state itself is estimated anew from it."""
        return {} if self._datum is None else {"datum": self._datum}

    def restore(self, kept: Mapping[str, object]) -> None:
        """Take back the origin, so that the map stays where it was."""
        if "datum" in kept:
            self._datum = np.array(kept["datum"], dtype=np.float64)

    def _shared_memory(self) -> Buffer | None:
        """Return memory for the propagator that another process reads; None if none does."""
        return None

    def _restart(self) -> None:
        settings = self._cabin
        level = ChassisLevel.of(
            self._machine, settings.chassis_imu, self._T_imu_cabin, self._turn, self._standing
        )
        self._first = FirstState(
            settings.rest,
            settings.window_start,
            self._antennas_imu,
            self._noise,
            level,
            settings.clock_std_s,
        )
        self._aligning: Aligning | None = None
        self._aligning_witness = AligningWitness()
        self._newest_s: float | None = None  # of the cabin's inertial sensor
        self._is_begun = False
        self._standing_s = -np.inf

    @property
    def refused(self) -> Mapping[str, int]:
        """Number of refused samples by stream and reason."""
        return dict(self._stamp_gate.refused)

    def add_imu(self, sample: ImuSample) -> None:
        if not self._stamp_gate.admits(sample.frame, sample.stamp_s, _JUMP_S):
            return
        if sample.frame == self._cabin.imu:
            self._add_cabin_sample(sample)
        elif sample.frame == self._cabin.chassis_imu and self._is_in_range(sample):
            self._standing.add(
                sample.stamp_s, sample.angular_velocity_rad_s, sample.specific_force_m_s2
            )

    def _is_in_range(self, sample: ImuSample) -> bool:
        """Return whether a sample is within a sensor's range; count it if it is not."""
        if is_beyond_range(sample.angular_velocity_rad_s, sample.specific_force_m_s2):
            self._stamp_gate.refuse(sample.frame, "out of range")
            return False
        return True

    def _add_cabin_sample(self, sample: ImuSample) -> None:
        """Propagate to a sample; this runs for each sample and must be fast, see `kernels`."""
        before_s = self._newest_s
        if not self._is_begun or before_s is None:
            self._begin(sample)
            return
        answered = self._propagator.step(
            sample.stamp_s, sample.angular_velocity_rad_s, sample.specific_force_m_s2
        )
        if answered >= 0:
            self._newest_s = sample.stamp_s
            self._sampled(sample, sample.stamp_s - before_s, answered)
        elif answered == OUT_OF_RANGE:
            self._stamp_gate.refuse(sample.frame, "out of range")
        else:
            self._begin_again(sample)

    def _begin_again(self, sample: ImuSample) -> None:
        """Discard the state after too long a gap, and restart with the sample after it."""
        self._stamp_gate.refuse(sample.frame, "gap, started again")
        self._propagator.forget_samples()
        self._restart()
        self._begin(sample)

    def _begin(self, sample: ImuSample) -> None:
        if not self._is_in_range(sample):
            return
        since_last_s = 0.0 if self._newest_s is None else sample.stamp_s - self._newest_s
        if not 0 <= since_last_s <= self._cabin.restart_after_s:
            self._begin_again(sample)
            return
        self._newest_s = sample.stamp_s
        inertial = Inertial(
            sample.stamp_s, sample.angular_velocity_rad_s, sample.specific_force_m_s2, since_last_s
        )
        self._align(inertial)
        found = self._first.add_sample(inertial, self._turn.velocity_rad_s)
        if found is not None and found.has_heading:
            self._is_begun, self._aligning = True, None
            self._start_at(found)
            return
        if found is not None:
            known = self._propagator, UNKNOWN_BODY_GATE, self._aligning_witness
            self._aligning = Aligning(found, self._noise, *known)
        if self._first.waits_for and not 0 <= sample.stamp_s - self._reported_s < _REPORT_PERIOD_S:
            self._report(sample.stamp_s, f"waits for {self._first.waits_for}")

    def _report(self, stamp_s: float, reason: str) -> None:
        """Report why there is no state with a heading."""
        self._reported_s = stamp_s
        status = INITIALISING if self._aligning is None else ALIGNING
        self._status_changes.append(StatusChange(stamp_s, status, status, reason))

    def _align(self, sample: Inertial) -> None:
        """Carry a state without a heading on to a sample."""
        if self._aligning is None:
            return
        if self._propagator.step(sample.stamp_s, sample.rate, sample.force) >= 0:
            self._aligning.add_sample(sample.stamp_s)

    def _agreeing_clock(self) -> AgreeingClock | None:
        """Return how likely the receiver's clock agrees; None if nothing is known of that."""
        settings = self._cabin
        if settings.clock_agrees == 0 or settings.clock_std_s == 0:
            return None
        return AgreeingClock(settings.clock_agrees, settings.clock_std_s)

    @abstractmethod
    def _start_at(self, found: Found) -> None:
        """Start from a first state with a heading, and set the propagator to it."""

    @abstractmethod
    def _sampled(self, sample: ImuSample, since_last_s: float, answered: int) -> None:
        """Handle a sample after the propagator has taken it; see `SmootherHost.sampled`."""

    def _position_of(self, fix: GnssFix) -> tuple[Float, Float] | None:
        """Return a fix in the map [m], shape (3,), and its covariance [m²], shape (3, 3).

        A fix that is too uncertain is counted; the answer is then None.
        """
        noise = self._cabin.gnss_scale**2 * fix.covariance_enu_m2
        if not 0 < np.diag(noise).max() < self._cabin.max_gnss_std_m**2:
            self._stamp_gate.refuse(fix.antenna, "too uncertain")
            return None
        if self._datum is None:
            self._datum = np.array(fix.geodetic)
        p_map = enu_from_geodetic(fix.geodetic, self._datum)
        if not self._is_begun:
            self._first.add_fix(fix.stamp_s, fix.antenna, p_map, noise)
            if self._aligning is not None:
                arm_imu = self._antennas_imu[fix.antenna]
                self._aligning.add_fix(Fix(fix.stamp_s, fix.antenna, arm_imu, p_map, noise))
        return p_map, noise

    def add_gnss(self, fix: GnssFix) -> None:
        if fix.antenna not in self._antennas_imu:
            self._stamp_gate.refuse(fix.antenna, "unknown antenna")
        elif self._admits_fix(fix):
            position = self._position_of(fix)
            if position is not None:
                self._use_fix(fix, *position)

    @abstractmethod
    def _admits_fix(self, fix: GnssFix) -> bool:
        """Return whether a fix's stamp is in order; count the fix if it is not."""

    @abstractmethod
    def _use_fix(self, fix: GnssFix, p_map_antenna: Float, noise: Float) -> None:
        """Correct by a fix.

        Args:
            fix: The fix.
            p_map_antenna: Antenna in the map [m], shape (3,).
            noise: Covariance of that position [m²], shape (3, 3).
        """

    def add_joints(self, sample: JointSample) -> None:
        if not self._stamp_gate.admits("joints", sample.stamp_s):
            return
        self._turn.update(sample)
        self._propagator.set_turn()
        is_due = sample.stamp_s - self._standing_s >= _STANDING_PERIOD_S - 1e-6
        if is_due and self._standing.is_at_rest(sample.stamp_s):
            self._standing_s = sample.stamp_s
            sway = self._standing.sway(_STANDING_PERIOD_S)
            self._use_standing(ChassisRest(sample.stamp_s, self._turn.rate_cabin, *sway))

    @abstractmethod
    def _use_standing(self, rest: ChassisRest) -> None:
        """Correct by a chassis at rest."""

    def account(self) -> Sequence[StatusChange]:
        """Return the changes of the status, and every few seconds what a start waits for."""
        return tuple(self._status_changes)

    @abstractmethod
    def _status(self) -> str:
        """Return the status that is reported with the state."""

    def state(self) -> BaseState:
        if self._turn.is_known and (self._is_begun or self._aligning is not None):
            return self._propagator.state(self._status() if self._is_begun else ALIGNING)
        nowhere, zeros = np.eye(4), np.zeros(3)
        at_s, P = self._newest_s or 0.0, 1e6 * np.eye(6)
        return BaseState(at_s, nowhere, nowhere, nowhere, zeros, zeros, P, INITIALISING)
