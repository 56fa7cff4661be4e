"""The odometry of a cabin, held against a filter that does not use it."""

from collections import deque
from collections.abc import Mapping
from dataclasses import replace
from operator import attrgetter

import numpy as np
from executive_plugins.estimation.filters.inertial_way import KeptFilter
from executive_plugins.estimation.filters.odometry_witness import OdometryWitness
from executive_plugins.estimation.live.propagator import LivePropagator

from executive.arrays import Float
from executive.geometry.pose import adjoint, inverse, transform
from executive.geometry.rotation import skew
from executive.machine.rig import Rig
from executive.messages.base_state import BaseState
from executive.messages.odometry import LidarIncrement


class OdometryWitnesses:
    """A witness for each stream of odometry; where one contradicts it, a state is less certain."""

    def __init__(
        self,
        rig: Rig,
        T_imu_cabin: Float,
        antennas_imu: Mapping[str, Float],
        kept_s: float,
        propagator: LivePropagator,
    ) -> None:
        """Begin without odometry.

        Args:
            rig: Tells where sensors are.
            T_imu_cabin: Cabin in the IMU's frame, shape (4, 4).
            antennas_imu: The antennas in IMU axes [m], shape (3,) each, by name.
            kept_s: The longest time over which motions are compared [s].
            propagator: Has the inertial samples.
        """
        self._rig, self._T_imu_cabin, self._known = rig, T_imu_cabin, (kept_s, propagator)
        middle = np.mean(list(antennas_imu.values()), axis=0)
        # Fixes hold the antennas: an error of the rotation moves the cabin about these.
        self._arm = transform(inverse(T_imu_cabin), middle)
        self._witnesses: dict[str, OdometryWitness] = {}
        self._waiting: deque[tuple[KeptFilter, LidarIncrement, bool]] = deque()
        # The one that contradicts a state most, kept because each inertial sample asks for it.
        self._widest: OdometryWitness | None = None

    def knows(self, frame: str) -> bool:
        """Return whether a sensor of odometry is on the cabin."""
        sensor = self._rig.sensors.get(frame)
        return sensor is not None and sensor.link == self._rig.cabin_link

    def look(self, kept: KeptFilter, increment: LidarIncrement, is_sound: bool) -> None:
        """Keep a filter at the end of an increment, to be compared later.

        Comparing takes longer than the rest of an inertial sample, and can wait for the next
        increment.

        Args:
            kept: A copy of the filter.
            increment: Of a frame that is known.
            is_sound: Whether nothing else speaks against the filter.
        """
        self._waiting.append((kept, increment, is_sound))

    def compare(self) -> float:
        """Compare what was kept; return when odometry contradicted a filter last [s], else -inf."""
        apart_s = -np.inf
        while self._waiting:
            kept, increment, is_sound = self._waiting.popleft()
            witness = self._witnesses.setdefault(increment.frame, OdometryWitness(*self._known))
            witness.take(kept, self._of_imu(increment), is_sound)
            if witness.is_apart:
                apart_s = max(apart_s, increment.to_s)
            widest = max(self._witnesses.values(), key=attrgetter("size2"))
            self._widest = widest if widest.size2 > 0.0 else None
        return float(apart_s)

    def _of_imu(self, increment: LidarIncrement) -> LidarIncrement:
        """Return the motion of the IMU."""
        T_imu_lidar = self._T_imu_cabin @ self._rig.sensors[increment.frame].T_link_sensor
        Ad = adjoint(T_imu_lidar)
        return replace(
            increment,
            T_from_to=T_imu_lidar @ increment.T_from_to @ inverse(T_imu_lidar),
            covariance=Ad @ increment.covariance @ Ad.T,
        )

    def widened(self, state: BaseState, by_fixes2: Float | None = None) -> BaseState:
        """Return a state whose covariance holds what odometry and fixes say as well.

        Args:
            state: The state.
            by_fixes2: See `FixWitness.moved2`.
        """
        witness = self._widest
        if witness is None and by_fixes2 is None:
            return state
        R, covariance = state.T_map_cabin[:3, :3], state.covariance.copy()
        if witness is not None:
            by_turn = np.vstack([np.eye(3), skew(self._arm)])
            covariance += by_turn @ R.T @ witness.turned2 @ R @ by_turn.T
            covariance[3:, 3:] += R.T @ witness.moved2 @ R
        if by_fixes2 is not None:
            covariance[3:, 3:] += R.T @ by_fixes2 @ R
        poses = state.T_map_base, state.T_odom_base, state.T_map_cabin
        rates = state.v_map_cabin, state.w_map_cabin_in_cabin
        return BaseState(state.stamp_s, *poses, *rates, covariance, state.status)
