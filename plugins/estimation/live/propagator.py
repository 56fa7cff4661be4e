"""The state at the newest inertial sample, propagated from the last estimate."""

import numpy as np
from executive_plugins.estimation.direct_call import direct
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.live.kernels import (
    GAP,
    OUT_OF_RANGE,
    Block,
    anchor,
    report,
    step,
    take,
)
from executive_plugins.estimation.live.layout import ANSWERS, LIVE
from executive_plugins.estimation.live.packed_state import ROW, PackedState
from executive_plugins.estimation.start.chassis import TurnJoint
from typing_extensions import Buffer

from executive.arrays import Float
from executive.messages.base_state import BaseState

__all__ = ["GAP", "OUT_OF_RANGE", "LivePropagator"]
_ROWS = 32  # reports allocated at once, which takes as long as allocating one
_step, _take, _anchor, _report = direct(step), direct(take), direct(anchor), direct(report)


class LivePropagator:
    """Propagates a state at each inertial sample, and replaces it when a new estimate arrives.

    An estimate of an earlier time is propagated through the samples since then. Corrections move
    the map frame relative to the odometry frame, so that the pose in the odometry frame has no
    steps (REP-105).

    Attributes:
        stamp_s: Time of the newest sample or estimate [s].
        samples: Number of samples since the start.
        ring: The newest samples, dtype `SAMPLE`: number k, counted from 0, in row k modulo its
            length.
    """

    def __init__(
        self,
        T_imu_cabin: Float,
        turn: TurnJoint,
        noise: InertialNoise,
        gap_s: float,
        memory: Buffer | None = None,
    ) -> None:
        """Make a propagator without a state.

        Args:
            T_imu_cabin: Cabin in the IMU's frame, shape (4, 4).
            turn: Joint between chassis and cabin.
            noise: Noise of the inertial sensor.
            gap_s: Longest time between two samples over which a state is propagated [s].
            memory: A buffer of `LIVE.itemsize` bytes that is shared with another process.
        """
        self.block: Block = (
            np.zeros(1, LIVE) if memory is None else np.frombuffer(memoryview(memory), LIVE, 1)
        )
        self._turn = turn
        self._has_state = False
        self._status = ""  # of the newest report
        self._rows: list[tuple[Block, PackedState]] = []
        self._newest: PackedState | None = None  # of the newest sample, if not changed since
        # Its row with the state over it, until that is handed out.
        self._kept: tuple[Block, PackedState] | None = None
        self.stamp_s, self.samples = -np.inf, 0
        self.ring: Block = self.block["samples"][0]
        self._state_s = self.block["stamp_s"]
        fixed = self.block[0]
        fixed["T_imu_cabin"], fixed["T_joint_base"], fixed["axis"] = (
            T_imu_cabin,
            turn.T_joint_base,
            turn.axis,
        )
        fixed["gravity_m_s2"], fixed["densities"], fixed["gap_s"] = (
            noise.gravity_m_s2,
            noise.densities,
            gap_s,
        )
        fixed["T_odom_map"] = np.eye(4)
        self.set_turn()

    def step(self, stamp_s: float, rate: Float, force: Float) -> int:
        """Propagate to a sample; see `kernels.step`."""
        row, state = kept = self._rows.pop() if self._rows else self._next_row()
        answered: int = _step(self.block, stamp_s, rate, force, row)
        if answered >= 0:
            self._newest, self.stamp_s, self._kept = state, stamp_s, kept
            self.samples += 1
        return answered

    def lengthen(self, since_last_s: float) -> None:
        """Say that the newest sample tells of a longer time than that since the one before [s]."""
        self.ring["since_last_s"][(self.samples - 1) % len(self.ring)] = since_last_s

    def set_turn(self) -> None:
        """Take over the newest sample of the turn joint, and allocate rows for reports."""
        turn, block = self._turn, self.block
        block["turn_s"], block["turn_rad"], block["turn_rad_s"] = (
            turn.stamp_s,
            turn.position_rad,
            turn.velocity_rad_s,
        )
        self._newest = None
        if len(self._rows) < _ROWS // 2:
            self._rows = _new_rows(self._status) + self._rows

    def forget_samples(self) -> None:
        """Exclude all samples so far from propagation.

        After a clock was set back, they would lie in the future of new estimates.
        """
        self.block["forgotten"] = self.block["written"]

    def take(self, estimate: Block, is_alone: bool = False) -> bool:
        """Replace the state by an estimate, propagated to the newest sample.

        Args:
            estimate: The estimate, shape (1,), dtype `ESTIMATE`.
            is_alone: Whether it is unrelated to the state before, so that the odometry frame stays
                where it is in the map.

        Returns:
            Whether the estimate was finite; if not, it is ignored.
        """
        if not _take(self.block, estimate, self._has_state and not is_alone):
            return False
        self._has_state, self._newest = True, None
        self.stamp_s = float(self._state_s.item())
        return True

    def _next_row(self) -> tuple[Block, PackedState]:
        """Return a row to be written, and the state over it."""
        if not self._rows:
            self._rows = _new_rows(self._status)
        return self._rows.pop()

    def rewritable(self) -> tuple[Block, PackedState]:
        """Return a row that was not handed out, for a new report, and the state over it."""
        if self._kept is None:
            self._kept = self._next_row()
        return self._kept

    def rewrite(self, state: PackedState) -> None:
        """Take the report that compiled code has written after it has changed the block.

        Args:
            state: The state over the row of `rewritable`.
        """
        self._newest = state

    def anchor(self, estimate: Block) -> None:
        """Propagate the covariance from an estimate and keep the state.

        The estimate has shape (1,) and dtype `ESTIMATE`.
        """
        _anchor(self.block, estimate)
        self._newest = None

    def take_answer(self, number: int) -> tuple[int, int]:
        """Replace the state by an estimate that the smoother's process has written into the block.

        Args:
            number: Number of the estimate, counted from 1.

        Returns:
            The number of its mode, negative if the estimate belongs to an earlier start and was
            ignored; and the number of messages that were sent before it.
        """
        answer = self._answer(number)
        if answer["epoch"][0] != self.epoch:
            return -1, 0
        _take(self.block, answer, True)
        self._newest = None
        return int(answer["mode"][0]), int(answer["messages"][0])

    def _answer(self, number: int) -> Block:
        """Return a copy of an estimate, or of a later one if it may have been written over.

        The smoother's process goes on while this one is held up, as on a busy computer.
        """
        while True:
            k = number % ANSWERS
            copy: Block = self.block["answers"][0][k : k + 1].copy()
            newest = int(self.block["answered"][0])
            if newest - number < ANSWERS - 1:  # the next one is written before it is counted
                return copy
            number = newest

    @property
    def epoch(self) -> int:
        """Number of the current start; estimates of other starts are ignored."""
        return int(self.block["epoch"][0])

    @epoch.setter
    def epoch(self, epoch: int) -> None:
        self.block["epoch"] = epoch

    def state(self, status: str) -> BaseState:
        """Return the state at the newest sample."""
        state, self._kept = self._newest, None
        if state is None:
            row, state = self._next_row()
            _report(self.block, row)
            self._newest = state
        if state.status != status:
            self._status = status
            state = self._newest = state.of_status(status)
        return state


def _new_rows(status: str) -> list[tuple[Block, PackedState]]:
    """Return writable rows, each with the state that is handed out: a read-only view of it.

    The states are made ahead as well, with the status that is likely, since a sample that makes
    an object takes longer.
    """
    rows = np.zeros(_ROWS, ROW)
    locked = rows.view()
    locked.flags.writeable = False
    return [(rows[k : k + 1], PackedState(locked[k : k + 1], status)) for k in range(_ROWS)]
