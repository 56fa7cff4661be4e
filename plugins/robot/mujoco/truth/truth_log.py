"""True poses and contacts, recorded while the world is stepped; only the oracle reads them."""

from collections.abc import Sequence

import mujoco
import numpy as np
from executive_plugins.robot.mujoco.truth.contact_log import ContactLog, Span
from executive_plugins.robot.mujoco.truth.truth_file import (
    Records,
    rests_as_arrays,
    rests_from,
    spans_as_array,
    spans_from,
)
from numpy.typing import NDArray

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.pose import interpolate, pose
from executive.machine.machine import Machine

_PERIOD_S = 0.1  # between two recorded poses
_EPSILON_S = 1e-6
_STILL = 1e-4  # largest change of an entry of the pose of a stone at rest between two records
_ELSEWHERE = 1e-3  # change of an entry from which a stone lies at another place [m], or as a sine


class TruthLog:
    """The true course of a run.

    Poses of stones, cabin and gripper are recorded ten times a second, contacts of the machine at
    every control step. Where each stone came to rest is kept beyond the end of the process, so that
    a mission that was cut off and resumed is judged against where its stones were found.
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
        self._rests: list[list[tuple[float, Float]]] = [[] for _ in self.stones]

    def keep(self) -> tuple[tuple[Float, Float], ...]:
        """Return for each stone since when it lay [s], shape (N,), and its poses, (N, 4, 4)."""
        return tuple(
            (np.array([since_s for since_s, _ in rests]), np.array([T for _, T in rests]))
            for rests in self._rests
        )

    def begin_at(
        self,
        time_s: float,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        kept: Sequence[tuple[Float, Float]],
    ) -> None:
        """Begin at a time [s] with what `keep` returned; the rest was in a process that has ended.

        Poses of stones before that time are those at which they were at rest last.
        """
        for records in (self._stamps_s, self._T_stones, self._T_cabin, self._T_gripper):
            records.clear()
        self._rests = [list(zip(map(float, s), T, strict=True)) for s, T in kept]
        self.step(time_s, model, data)

    def records(self) -> Records:
        """Return all that was recorded, as arrays by name."""
        return {
            "names": np.array(self.stones, dtype=str),
            "stamps_s": np.array(self._stamps_s),
            "stone_poses": np.array(self._T_stones).reshape(-1, len(self.stones), 4, 4),
            "cabin_poses": np.array(self._T_cabin),
            "gripper_poses": np.array(self._T_gripper),
            "contacts": spans_as_array(self.spans()),
            **rests_as_arrays(self._rests),
        }

    def take(self, records: Records, zero_s: float) -> None:
        """Take what another process has recorded, instead of all that was recorded here.

        Args:
            records: What `records` returned there.
            zero_s: The time of that process's clock that is taken as zero [s].

        Raises:
            DataError: If they are of other stones, or incomplete.
        """
        if tuple(records.get("names", ())) != self.stones:
            raise DataError("the truth of the run is of another site than its mission's")
        try:
            self._stamps_s = [float(at_s) - zero_s for at_s in records["stamps_s"].tolist()]
            self._T_stones = [list(poses) for poses in _floats(records["stone_poses"])]
            self._T_cabin = list(_floats(records["cabin_poses"]))
            self._T_gripper = list(_floats(records["gripper_poses"]))
            self.contacts.take(spans_from(records["contacts"], zero_s))
            self._rests = rests_from(records, len(self.stones), zero_s)
        except (KeyError, TypeError, ValueError, IndexError) as error:
            raise DataError(f"the truth of the run is incomplete: {error}") from error

    def step(self, time_s: float, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Record the end of a control step; poses and contacts in `data` must be up to date."""
        self.contacts.step(time_s, model, data)
        if not self._stamps_s or _periods(time_s) > _periods(self._stamps_s[-1]):
            self._stamps_s.append(time_s)
            self._T_stones.append([_pose(data, i) for i in self._stone_ids])
            self._T_cabin.append(_pose(data, self._cabin_id))
            self._T_gripper.append(_pose(data, self._gripper_id))
            self._note_rests(time_s)

    def _note_rests(self, time_s: float) -> None:
        """Note each stone that has come to rest at another place than before."""
        before = self._T_stones[-2] if len(self._T_stones) > 1 else self._T_stones[-1]
        for T, last, rests in zip(self._T_stones[-1], before, self._rests, strict=True):
            is_still = np.abs(T - last).max() < _STILL
            if is_still and (not rests or np.abs(T - rests[-1][1]).max() > _ELSEWHERE):
                rests.append((time_s, T))

    @property
    def end_s(self) -> float:
        """Time of the last record [s]."""
        return self._stamps_s[-1]

    def T_world_stone(self, stone: int, time_s: float) -> Float:
        """Return the pose of a stone at a time, interpolated, shape (4, 4).

        The origin of its frame is the centroid of its volume.
        """
        rests = self._rests[stone]
        if rests and time_s < self._stamps_s[0] - _EPSILON_S:
            since = sum(since_s <= time_s + _EPSILON_S for since_s, _ in rests)
            return rests[max(since - 1, 0)][1]
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


def _floats(array: NDArray[np.generic]) -> Float:
    return np.asarray(array, dtype=np.float64)


def _pose(data: mujoco.MjData, body: int) -> Float:
    return pose(data.xmat[body].reshape(3, 3), data.xpos[body])
