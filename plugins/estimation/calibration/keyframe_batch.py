"""Calibration by one least-squares problem over keyframes of a whole recording.

Lever arms and clocks of the antennas are unknowns beside the motion, as in Kalibr (Furgale et al.
2013, a clock per sensor) and Holistic Fusion (Nubert 2025); keyframes at the fixes with
preintegrated samples between them (Forster 2017) take the place of splines. Since a clock moves
the keyframes, the problem is set up again until clocks and scales stay where they are. What other
odometry says of its mounting is then solved beside the motion that was found (hand-eye).
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from executive_plugins.estimation.cabin.sensors import cabin_imu
from executive_plugins.estimation.calibration.first_guess import FirstGuess
from executive_plugins.estimation.calibration.keyframe_problem import (
    KeyframeProblem,
    Receiver,
    Solved,
    Unknowns,
    walking,
)
from executive_plugins.estimation.calibration.quantities import (
    inertial_quantities,
    odometry_quantities,
    receiver_quantities,
)
from executive_plugins.estimation.calibration.settings import KeyframeBatchSettings
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import InertialState

from executive.errors import DataError
from executive.interfaces.calibration import Calibrator, Quantity
from executive.interfaces.recorded_log import RecordedBody
from executive.machine.rig import Rig
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement

_ROUNDS = 4
_COARSE = 10  # the rounds begin with so many times fewer keyframes
_STILL_S = 2e-4  # change of a clock below which the keyframes stay where they are
_SAME_SCALE = 1.05  # factor on a variance that is no change
_UNDETERMINED = (
    "calibration: the fixes do not determine the motion; record some minutes with an antenna that "
    "sees the sky, and turns, starts and halts"
)
_UNFITTING = (
    "calibration: no motion was found that the fixes fit: they err {times:.0f} times as much as "
    "they declare; check their covariance and whether the declared lever arms are right within "
    "'arm_std_m' ({arm_std_m:g} m)"
)
_LEAST_SCALE = 0.01  # of a declared covariance: a standard deviation ten times too large
# A receiver that declares a centimetre errs by a metre where it has no fixed solution: a hundred
# deviations. What fits worse is no motion of the antennas.
_LARGEST_SCALE = 1e4


class KeyframeBatch(Calibrator):
    """Clocks, lever arms, mounting and noise of the sensors that sit on the IMU's link."""

    Settings = KeyframeBatchSettings

    def __init__(self, settings: KeyframeBatchSettings, machine: Rig) -> None:
        self._settings, self._machine = settings, machine

    @classmethod
    def settings_for(cls, body: RecordedBody) -> Mapping[str, object]:
        known = dict(FirstGuess.settings_for(body))
        # Whether clocks agree is what is asked here, also of a machine with a description.
        return known | {"clock_std_s": cls.Settings().unknown_clock_s}

    @property
    def datum(self) -> tuple[float, float, float] | None:
        return self._settings.datum

    def calibrate(self, observations: Iterable[Observation | LidarIncrement]) -> Sequence[Quantity]:
        guess = FirstGuess(self._settings, self._machine)
        guess.start()
        try:
            guess.feed(observations)
        finally:
            guess.close()
        imu = cabin_imu(self._machine, self._settings.imu)
        inertial = inertial_quantities(imu, guess.samples)
        found = {one.name: float(one.value[0]) for one in inertial if one.is_found.all()}
        noise = walking(
            InertialNoise.of(imu.model_copy(update=found), 1.0, self._settings.gravity_m_s2)
        )
        solved = self._solved(guess, noise)
        settings, machine = self._settings, self._machine
        return (
            *inertial,
            *receiver_quantities(solved, machine, imu, settings),
            *odometry_quantities(guess.increments, solved, guess.samples, machine, imu, settings),
        )

    def _solved(self, guess: FirstGuess, noise: InertialNoise) -> Solved:
        """Set the problem up and solve it until clocks and scales stay where they are.

        Raises:
            DataError: If the fixes do not determine the motion, or fit none.
        """
        settings = self._settings
        arms = {fix.antenna: fix.arm_imu for fix in guess.fixes}
        receivers = tuple(Receiver(names, guess.clock_s) for names in _clocks(guess.fixes))
        unknowns = Unknowns(arms, arms, receivers, settings.arm_std_m, settings.unknown_clock_s)
        states: Sequence[InertialState] = guess.track()
        for keyframes in (settings.keyframes // _COARSE, settings.keyframes):
            fixes = list(self._thinned(guess.fixes, keyframes))
            solved = _settled(fixes, states, guess.samples, noise, unknowns)
            unknowns, states = _rescaled(solved), solved.states
        scale = max(one.scale for one in unknowns.receivers)
        if scale > _LARGEST_SCALE:
            times, arm_std_m = float(np.sqrt(scale)), settings.arm_std_m
            raise DataError(_UNFITTING.format(times=times, arm_std_m=arm_std_m))
        return solved

    def _thinned(self, fixes: Sequence[Fix], keyframes: int) -> Iterator[Fix]:
        """Yield fixes so far apart that they are independent, and no more than keyframes."""
        span_s = fixes[-1].stamp_s - fixes[0].stamp_s
        period_s = max(self._settings.keyframe_period_s, span_s / keyframes)
        next_s: dict[str, float] = {}
        for fix in sorted(fixes, key=lambda fix: fix.stamp_s):
            if fix.stamp_s >= next_s.get(fix.antenna, -np.inf) - 0.01 * period_s:
                next_s[fix.antenna] = fix.stamp_s + period_s
                yield fix


def _settled(
    fixes: Sequence[Fix],
    states: Sequence[InertialState],
    samples: SampleBuffer,
    noise: InertialNoise,
    unknowns: Unknowns,
) -> Solved:
    """Solve anew with the newest clocks and scales until they stay where they are."""
    rounds = 0
    while True:
        solved = KeyframeProblem(fixes, states, samples, noise, unknowns).solved()
        if solved is None:
            raise DataError(_UNDETERMINED)
        unknowns, states, rounds = _rescaled(solved), solved.states, rounds + 1
        is_same = 1 / _SAME_SCALE < solved.misfit < _SAME_SCALE
        if rounds == _ROUNDS or (solved.moved_s < _STILL_S and is_same):
            return solved


def _clocks(fixes: Sequence[Fix]) -> list[tuple[str, ...]]:
    """Return the antennas by receiver: those whose fixes bear the same stamps share a clock."""
    stamps: dict[str, set[float]] = {}
    for fix in fixes:
        stamps.setdefault(fix.antenna, set()).add(fix.stamp_s)
    receivers: list[list[str]] = []
    for name, own in stamps.items():
        for receiver in receivers:
            if len(own & stamps[receiver[0]]) > len(own) / 2:
                receiver.append(name)
                break
        else:
            receivers.append([name])
    return [tuple(names) for names in receivers]


def _rescaled(solved: Solved) -> Unknowns:
    """Return the unknowns with the fixes' covariances scaled by the misfit.

    The noise of the samples is measured, so that what is left is of the fixes.
    """
    receivers = tuple(
        replace(one, scale=max(one.scale * solved.misfit, _LEAST_SCALE))
        for one in solved.unknowns.receivers
    )
    return replace(solved.unknowns, receivers=receivers)
