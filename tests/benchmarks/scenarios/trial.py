"""One estimator on one stream: its state after each inertial sample, beside the truth."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from executive.arrays import Float
from executive.geometry.pose import inverse
from executive.geometry.rotation import log_so3
from executive.interfaces.estimation import Estimator
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.odometry import LidarIncrement
from scenarios.streams import Message
from scenarios.truth import Truth


@dataclass
class Trial:
    """The answers of one estimator.

    Attributes:
        truth: Where the machine was.
        states: After each sample of the cabin's inertial sensor, from the first that may be used.
        refused: Samples refused by stream and reason.
        fixes: Number of fixes fed once it was ready.
        increments: The lidar odometry that it was fed.
    """

    truth: Truth
    states: Sequence[BaseState]
    refused: Mapping[str, int]
    fixes: int
    increments: Sequence[LidarIncrement]

    @classmethod
    def run(
        cls, estimator: Estimator, truth: Truth, stream: Sequence[tuple[float, Message]]
    ) -> "Trial":
        """Feed a whole stream."""
        states: list[BaseState] = []
        fixes = 0
        estimator.start()
        try:
            for _, message in stream:
                estimator.add(message)
                if isinstance(message, GnssFix) and states:
                    fixes += 1
                if isinstance(message, ImuSample) and message.frame == "imu_cabin":
                    state = estimator.state()
                    if state.is_ready:
                        states.append(state)
        finally:
            estimator.close()
        increments = [message for _, message in stream if isinstance(message, LidarIncrement)]
        return cls(truth, states, dict(getattr(estimator, "refused", {})), fixes, increments)

    def chain(self, from_s: float, to_s: float) -> tuple[Float, Float]:
        """Return times [s] and poses of the lidar by its increments alone, between two times, shape
        (m,), (m, 4, 4).
        """
        stamps, poses = [], [np.eye(4)]
        for increment in self.increments:
            if from_s <= increment.to_s <= to_s:
                stamps.append(increment.to_s)
                poses.append(poses[-1] @ increment.T_from_to)
        return np.array(stamps), np.array(poses[1:])

    @cached_property
    def stamps_s(self) -> Float:
        """Time of each state [s], shape (n,)."""
        return np.array([state.stamp_s for state in self.states])

    @cached_property
    def T_map_cabin(self) -> Float:
        """The cabin as estimated, shape (n, 4, 4)."""
        return np.array([state.T_map_cabin for state in self.states])

    @cached_property
    def T_true(self) -> Float:
        """The cabin as it was, shape (n, 4, 4)."""
        return self.truth.T_map_cabin(self.stamps_s)

    @cached_property
    def error_m(self) -> Float:
        """Estimated minus true position of the cabin [m], shape (n, 3)."""
        return np.asarray(self.T_map_cabin[:, :3, 3] - self.T_true[:, :3, 3])

    @cached_property
    def antenna_error_m(self) -> Float:
        """The same of the left antenna, which is what satellites see [m], shape (n, 3)."""
        arm = self.truth.machine.sensors["gnss_left"].T_link_sensor[:3, 3]
        return np.asarray(self.error_m + (self.T_map_cabin - self.T_true)[:, :3, :3] @ arm)

    @cached_property
    def off_m(self) -> Float:
        """How far the estimate is from the truth [m], shape (n,)."""
        return np.asarray(np.linalg.norm(self.error_m, axis=1))

    @cached_property
    def is_global(self) -> Float:
        """Whether the estimator's status is GLOBAL, shape (n,)."""
        return np.array([state.status == "GLOBAL" for state in self.states])

    @cached_property
    def odometry_step_m(self) -> Float:
        """How much farther the cabin moved in the odometry frame between two states than v·dt [m],
        shape (n − 1,).
        """
        T_odom = [s.T_odom_base @ inverse(s.T_map_base) @ s.T_map_cabin for s in self.states]
        moved = np.linalg.norm(np.diff([T[:3, 3] for T in T_odom], axis=0), axis=1)
        speed = np.linalg.norm([s.v_map_cabin for s in self.states], axis=1)
        return np.asarray(moved - np.diff(self.stamps_s) * np.maximum(speed[1:], speed[:-1]))

    @cached_property
    def consistency_m(self) -> Float:
        """By how much each correction moved the pose at its own time [m] (Nubert 2022, Sec. V-B1),
        shape (m,).

        The odometry frame is the propagated pose, so that a change of T_map_odom is a correction
        and nothing else.
        """
        T_map_odom = np.array([s.T_map_base @ inverse(s.T_odom_base) for s in self.states])
        p_odom = np.array([s.T_odom_base[:3, 3] for s in self.states])
        before = (
            np.einsum("nij,nj->ni", T_map_odom[:-1, :3, :3], p_odom[1:]) + T_map_odom[:-1, :3, 3]
        )
        moved = np.linalg.norm(before - [s.T_map_base[:3, 3] for s in self.states[1:]], axis=1)
        return np.asarray(moved[moved > 1e-6])

    def nees(self, every: int = 10) -> Float:
        """Return the squared error of the pose in units of its covariance, 6 degrees of freedom,
        shape (n/every,).
        """
        squares = []
        for state, T_true in zip(self.states[::every], self.T_true[::every], strict=True):
            D = inverse(T_true) @ state.T_map_cabin
            error = np.concatenate([log_so3(D[:3, :3]), D[:3, 3]])
            squares.append(error @ np.linalg.solve(state.covariance, error))
        return np.array(squares)
