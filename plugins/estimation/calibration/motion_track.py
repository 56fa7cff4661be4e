"""The motion of a solved recording at any time, by the inertial samples between keyframes."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import Inertial, InertialState, propagate
from scipy.spatial.transform import Rotation, Slerp

from executive.arrays import Float
from executive.geometry.rotation import exp_so3, log_so3


class MotionTrack:
    """Poses of the IMU in the map, densely sampled."""

    def __init__(
        self, keyframes: Sequence[InertialState], samples: SampleBuffer, gravity_m_s2: float
    ) -> None:
        """Carry each keyframe on to the next, and spread what they then differ by over the time.

        With a step at each keyframe, the residuals of increments would have steps as well where
        their clock moves them past a keyframe, and a least-squares problem minima between these.
        """
        states: list[InertialState] = []
        for first, second in pairwise(keyframes):
            between = samples.between(first.stamp_s, second.stamp_s)
            states += _ending_at(second, _carried(first, between, gravity_m_s2))[:-1]
        states += keyframes[-1:]
        self._stamps_s = np.array([state.stamp_s for state in states])
        self._p = np.array([state.p_map_imu for state in states])
        self._turns = Slerp(
            self._stamps_s, Rotation.from_matrix([state.R_map_imu for state in states])
        )

    @property
    def span_s(self) -> tuple[float, float]:
        """The first and the last time [s]."""
        return float(self._stamps_s[0]), float(self._stamps_s[-1])

    def at(self, stamps_s: Float) -> tuple[Rotation, Float]:
        """Return orientations and positions, shape (n, 3); a time outside takes the nearest end."""
        inside = np.clip(stamps_s, *self.span_s)
        p = np.column_stack([np.interp(inside, self._stamps_s, self._p[:, i]) for i in range(3)])
        return self._turns(inside), p


def _carried(
    state: InertialState, samples: Sequence[Inertial], gravity_m_s2: float
) -> list[InertialState]:
    """Return a state, and where each sample takes it."""
    states = [state]
    for sample in samples:
        states.append(propagate(states[-1], sample, gravity_m_s2))
    return states


def _ending_at(keyframe: InertialState, states: Sequence[InertialState]) -> list[InertialState]:
    """Return states that end where a keyframe is: what they are off by grows with the time."""
    first, last, ended = states[0], states[-1], []
    turn = log_so3(last.R_map_imu.T @ keyframe.R_map_imu)
    shift = keyframe.p_map_imu - last.p_map_imu
    for state in states:
        share = (state.stamp_s - first.stamp_s) / (last.stamp_s - first.stamp_s)
        R = state.R_map_imu @ exp_so3(share * turn)
        ended.append(replace(state, R_map_imu=R, p_map_imu=state.p_map_imu + share * shift))
    return ended
