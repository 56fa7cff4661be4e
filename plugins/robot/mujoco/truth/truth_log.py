"""True poses and contacts, recorded while the world is stepped; only the oracle reads them."""

from collections.abc import Sequence

import mujoco
import numpy as np
from executive_plugins.robot.mujoco.truth.contact_log import ContactLog, Span

from executive.arrays import Float
from executive.geometry.pose import interpolate, pose
from executive.machine.machine import Machine

_PERIOD_S = 0.1  # between two recorded poses
_EPSILON_S = 1e-6


class TruthLog:
    """The true course of a run.

    Poses of stones, cabin and gripper are recorded ten times a second, contacts of the machine at
    every control step.
    """

    def __init__(self, machine: Machine, stones: Sequence[str], model: mujoco.MjModel) -> None:
        self.stones = tuple(stones)
        self._stone_ids = np.array([model.body(name).id for name in self.stones], dtype=int)
        self._cabin_id = model.body(machine.cabin_link).id
        self._gripper_id = model.body(machine.gripper_link).id
        self.contacts = ContactLog(machine, self.stones, model)
        self._stamps_s: list[float] = []
        self._T_stones: list[list[Float]] = []
        self._T_cabin: list[Float] = []
        self._T_gripper: list[Float] = []

    def begin_at(self, time_s: float, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Forget everything before a time [s]: it was in a process that has ended."""
        for records in (self._stamps_s, self._T_stones, self._T_cabin, self._T_gripper):
            records.clear()
        self.step(time_s, model, data)

    def step(self, time_s: float, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Record the end of a control step; poses and contacts in `data` must be up to date."""
        self.contacts.step(time_s, model, data)
        if not self._stamps_s or _periods(time_s) > _periods(self._stamps_s[-1]):
            self._stamps_s.append(time_s)
            self._T_stones.append([_pose(data, i) for i in self._stone_ids])
            self._T_cabin.append(_pose(data, self._cabin_id))
            self._T_gripper.append(_pose(data, self._gripper_id))

    @property
    def end_s(self) -> float:
        """Time of the last record [s]."""
        return self._stamps_s[-1]

    def T_world_stone(self, stone: int, time_s: float) -> Float:
        """Return the pose of a stone at a time, interpolated, shape (4, 4).

        The origin of its frame is the centroid of its volume.
        """
        i, fraction = self._bracket(time_s)
        return interpolate(
            self._T_stones[i][stone], self._T_stones[min(i + 1, self._last)][stone], fraction
        )

    def T_world_cabin(self, time_s: float) -> Float:
        """Return the cabin's pose at a time, interpolated, shape (4, 4)."""
        i, fraction = self._bracket(time_s)
        return interpolate(self._T_cabin[i], self._T_cabin[min(i + 1, self._last)], fraction)

    def holding(self, stone: int, from_s: float, to_s: float) -> tuple[Float, Float]:
        """Return heights of a stone, and its distances from the palm, in a span [m], (N,) each."""
        stamps = np.array(self._stamps_s)
        inside = np.flatnonzero((stamps >= from_s - _EPSILON_S) & (stamps <= to_s + _EPSILON_S))
        centroids = np.array([self._T_stones[i][stone][:3, 3] for i in inside]).reshape(-1, 3)
        palms = np.array([self._T_gripper[i][:3, 3] for i in inside]).reshape(-1, 3)
        return centroids[:, 2], np.linalg.norm(centroids - palms, axis=1)

    def centroids(self, time_s: float) -> Float:
        """Return the positions of all stones at a time [m], shape (S, 3)."""
        return np.array(
            [self.T_world_stone(i, time_s)[:3, 3] for i in range(len(self.stones))]
        ).reshape(-1, 3)

    def spans(self) -> tuple[Span, ...]:
        """Return all contacts of the machine so far."""
        return self.contacts.spans()

    @property
    def _last(self) -> int:
        return len(self._stamps_s) - 1

    def _bracket(self, time_s: float) -> tuple[int, float]:
        i = int(np.clip(np.searchsorted(self._stamps_s, time_s, side="right") - 1, 0, self._last))
        if i == self._last:
            return i, 0.0
        fraction = (time_s - self._stamps_s[i]) / (self._stamps_s[i + 1] - self._stamps_s[i])
        return i, float(np.clip(fraction, 0.0, 1.0))


def _periods(time_s: float) -> int:
    return int((time_s + _EPSILON_S) / _PERIOD_S)


def _pose(data: mujoco.MjData, body: int) -> Float:
    return pose(data.xmat[body].reshape(3, 3), data.xpos[body])
