"""The state at the newest inertial sample, and the report of it: what an inertial sample is served
from.
"""

from typing import Any

import numpy as np
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.live.kernels import (
    GAP,
    MODES,
    OUT_OF_RANGE,
    Block,
    anchor,
    report,
    step,
    take,
    take_answer,
)
from executive_plugins.estimation.live.layout import LIVE
from executive_plugins.estimation.live.packed_state import ROW, PackedState
from executive_plugins.estimation.live.packing import is_finite
from executive_plugins.estimation.start.chassis import TurnJoint

from executive.arrays import Float
from executive.messages.base_state import BaseState

__all__ = ["GAP", "OUT_OF_RANGE", "LivePropagator"]
_ROWS = 32  # reports that are made room for at once, which costs as much as for one


class LivePropagator:
    """Carries a state on from sample to sample; estimates take its place. The odometry frame never
    steps (REP-105).

    Attributes:
        stamp_s: Time of the newest sample or estimate [s].
        samples: Number of samples since the start.
    """

    def __init__(
        self,
        T_imu_cabin: Float,
        turn: TurnJoint,
        noise: InertialNoise,
        gap_s: float,
        memory: Any = None,
    ) -> None:
        """Make a propagator without a state.

        Args:
            T_imu_cabin: Shape (4, 4).
            turn: Of the chassis under the cabin.
            noise: Of the inertial sensor.
            gap_s: Time between two samples after which a state is worth nothing [s].
            memory: A buffer of `LIVE.itemsize` bytes that another process reads and writes as well.
        """
        self.block: Block = np.zeros(1, LIVE) if memory is None else np.frombuffer(memory, LIVE, 1)
        self._turn = turn
        self._has_state = False
        self._rows: list[tuple[Block, Block]] = []
        self._row: Block | None = None  # the report of the newest sample, if nothing has come since
        self.stamp_s, self.samples = -np.inf, 0
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
        self.turned()

    def step(self, stamp_s: float, rate: Float, force: Float) -> int:
        """Go on to a sample; see `live_kernels.step`."""
        if not self._rows:
            self._rows = _new_rows()
        row, locked = self._rows.pop()
        answered: int = step(self.block, stamp_s, rate, force, row)
        if answered >= 0:
            self._row, self.stamp_s = locked, stamp_s
            self.samples += 1
        return answered

    def turned(self) -> None:
        """Take notice of what the turn joint has measured, and make room for reports while nobody
        waits.
        """
        turn, block = self._turn, self.block
        block["turn_s"], block["turn_rad"], block["turn_rad_s"] = (
            turn.stamp_s,
            turn.position_rad,
            turn.velocity_rad_s,
        )
        self._row = None
        if len(self._rows) < _ROWS // 2:
            self._rows = _new_rows() + self._rows

    def forget_samples(self) -> None:
        """Carry no estimate on through the samples so far: a clock that was set back has put them
        in its future.
        """
        self.block["forgotten"] = self.block["written"]

    def take(self, estimate: Block, is_alone: bool = False) -> bool:
        """Put an estimate in the state's place, shape (1,), dtype `ESTIMATE`; not one that is not
        finite.

        Args:
            estimate: The estimate; the propagator goes on from it to the newest sample.
            is_alone: Whether it corrects nothing: map and odometry stay as they lie to one another.

        Returns:
            Whether it was finite, and taken.
        """
        if not is_finite(estimate):
            return False
        take(self.block, estimate, self._has_state and not is_alone)
        self._has_state, self._row, self.stamp_s = True, None, float(self.block["stamp_s"][0])
        return True

    def anchor(self, estimate: Block) -> None:
        """Carry the covariance on from an estimate, shape (1,), dtype `ESTIMATE`, and leave the
        state as it is.
        """
        anchor(self.block, estimate)
        self._row = None

    def take_answer(self, number: int) -> tuple[int, int]:
        """Put an estimate that lies in the block in the state's place.

        Returns:
            Its mode's number, negative if it is of another epoch and not taken; and the number of
            messages until then.
        """
        answer = take_answer(self.block, number)
        if answer < 0:
            return answer, 0
        self._row = None
        messages, mode = divmod(answer, MODES)
        return mode, messages

    @property
    def epoch(self) -> int:
        """Number of the beginning that answers must go back to."""
        return int(self.block["epoch"][0])

    @epoch.setter
    def epoch(self, epoch: int) -> None:
        self.block["epoch"] = epoch

    def state(self, status: str) -> BaseState:
        """Report the newest sample."""
        if self._row is None:
            row, self._row = (self._rows or _new_rows()).pop()
            report(self.block, row)
        return PackedState(self.stamp_s, self._row, status)


def _new_rows() -> list[tuple[Block, Block]]:
    """Return rows to be written, each with a locked view of itself to be handed out."""
    rows = np.zeros(_ROWS, ROW)
    locked = rows.view()
    locked.flags.writeable = False
    return [(rows[k : k + 1], locked[k : k + 1]) for k in range(_ROWS)]
