"""The motion of a solved recording at any time, by the inertial samples between keyframes."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import InertialState, propagate
from scipy.spatial.transform import Rotation, Slerp

from executive.arrays import Float


class MotionTrack:
    """Poses of the IMU in the map, densely sampled."""

    def __init__(
        self, keyframes: Sequence[InertialState], samples: SampleBuffer, gravity_m_s2: float
    ) -> None:
        """Carry each keyframe on to the next; what they then differ by is left where it is."""
        states: list[InertialState] = []
        for first, second in pairwise(keyframes):
            state = first
            states.append(state)
            for sample in samples.between(first.stamp_s, second.stamp_s)[:-1]:
                state = propagate(state, sample, gravity_m_s2)
                states.append(state)
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
