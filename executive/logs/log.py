"""A recorded log as a stream of observations, and the rig that carried the sensors."""

import logging
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from executive.arrays import Float
from executive.errors import DataError, ShapeError, did_you_mean
from executive.geometry.pose import inverse
from executive.logs import decode
from executive.logs.extrinsics import rig_from, rig_of_levers
from executive.logs.log_source import LogSource, Recorded
from executive.logs.topics import METADATA, TYPES, Topics
from executive.machine.machine import load_machine
from executive.machine.rig import Rig
from executive.messages.observation import Observation
from executive.messages.odometry import LidarIncrement

_log = logging.getLogger(__name__)

_SHOWN = 200  # characters of an error that another package raised
_HEAD = 2000  # number of messages within which each sensor must appear
# Standard deviation of increments that were recorded without one: rotation [rad], position [m].
_INCREMENT_STD = np.repeat([0.003, 0.02], 3)


@dataclass(slots=True)
class Skipped:
    """Messages of one topic that were left out because of an invalid value.

    Attributes:
        count: Number of messages.
        first_s: Arrival of the first, since the log's first message [s].
        reason: The error in the first.
    """

    count: int
    first_s: float
    reason: str


@dataclass(frozen=True, slots=True)
class CutOff:
    """What is read of a log that was cut off, such as by a killed recorder.

    Attributes:
        read_bytes: Number of bytes that are read.
        file_bytes: Size of the file.
        until_s: Arrival of the last message that is read, since the log's first message [s].
    """

    read_bytes: int
    file_bytes: int
    until_s: float


@dataclass(frozen=True, slots=True)
class Arrival:
    """One observation and the time of its arrival [s], since the log's first message."""

    arrival_s: float
    observation: Observation | LidarIncrement


class Log:
    """A log of inertial and satellite measurements, and of other sensors if present.

    Attributes:
        path: The file or folder.
        origin_ns: Arrival of the first message [ns]; all times count from it.
        skipped: Messages that `arrivals` has left out, by topic.
        cut: What is read of a log that was cut off; None for a whole log.
    """

    def __init__(self, path: Path, topics: Topics) -> None:
        """Open a log.

        Raises:
            DataError: If the log is incomplete, lacks inertial or satellite measurements, or a
            topic has another type.
        """
        self.path = path
        self._source = LogSource(path)
        self._topics = {
            name: kind
            for kind, name in topics.model_dump().items()
            if name in self._source.types or _is_needed(kind)
        }
        for name, kind in self._topics.items():
            self._check(name, kind)
        first = next(self._source.messages(list(self._topics)), None)
        if first is None:
            raise DataError(f"{path}: the log is empty")
        self.origin_ns = first.arrival_ns
        self.cut = self._told_cut()
        self.skipped: dict[str, Skipped] = {}

    def _told_cut(self) -> CutOff | None:
        cut = self._source.cut
        if cut is None:
            return None
        until_s = round(1e-9 * (cut.last_ns - self.origin_ns), 3)
        _log.warning(
            "%s: cut off, as by a killed recorder: %d of %d bytes are read, until %.3f s",
            self.path, cut.read_bytes, cut.file_bytes, until_s,
        )  # fmt: skip
        return CutOff(cut.read_bytes, cut.file_bytes, until_s)

    def rig(self, model: str | None, levers: Mapping[str, Float] | None = None) -> Rig:
        """Return the rig that carried the sensors.

        Args:
            model: Name of a machine's description. None for the machine that the log names; if it
                names none, the rig is made from the log's static transforms.
            levers: Place of sensors by their frame, in the axes of the inertial sensor and from it
                [m], shape (3,) each, for a log without static transforms: all are of one body.

        Raises:
            DataError: If the extrinsics of a sensor are missing.
        """
        model = model or self._source.metadata(METADATA).get("machine")
        if model:
            return load_machine(model)
        named, frames = {kind: name for name, kind in self._topics.items()}, self._frames()
        if levers:
            return rig_of_levers(levers, frames, str(self.path))
        if "tf_static" not in named:
            others = [frame for frame, kind in frames.items() if kind != "imu"]
            example = " ".join(f"--lever {frame}:0,0,0" for frame in others)
            raise DataError(
                f"{self.path}: no extrinsics: record tf_static, name the machine with --machine, "
                f"or say where the sensors are from the inertial one, in its axes [m]: {example}"
            )
        transforms = [
            t
            for recorded in self._source.messages([named["tf_static"]])
            for t in recorded.message.transforms
        ]
        try:
            return rig_from(transforms, frames, str(self.path))
        except (ShapeError, ValueError) as error:  # a rotation or a position that is none
            reason = " ".join(str(error).split())[:_SHOWN]
            raise DataError(
                f"{self.path}: tf_static holds what is no transform ({reason}); record it again, "
                "or name the machine with --machine"
            ) from error

    def _frames(self) -> Mapping[str, str]:
        """Return the kind of sensor of each frame in the log's first messages."""
        frames: dict[str, str] = {}
        carried = {
            name: kind
            for name, kind in self._topics.items()
            if kind in ("imu", "gnss", "points", "odometry")
        }
        for recorded in islice(self._source.messages(list(carried)), _HEAD):
            kind = carried[recorded.topic]
            message = recorded.message
            frames[message.child_frame_id if kind == "odometry" else message.header.frame_id] = kind
        return frames

    def arrivals(self) -> Iterator[Arrival]:
        """Yield all measurements in order of arrival.

        Receivers' messages without a fix are left out. A message with an invalid value, such as
        NaN, is left out and counted in `skipped`, so that one bad sample does not make a log
        useless.

        Raises:
            DataError: If the file ends early, or all messages of a topic lack a field that is
            needed.
        """
        self.skipped.clear()
        readers = self._readers()
        for recorded in self._source.messages(list(self._topics)):
            read = readers.get(self._topics[recorded.topic])
            observation = self._read(recorded, read) if read is not None else None
            if observation is not None:
                yield Arrival(1e-9 * (recorded.arrival_ns - self.origin_ns), observation)

    def _read(
        self, recorded: Recorded, read: Callable[[Any, float], Observation | LidarIncrement | None]
    ) -> Observation | LidarIncrement | None:
        stamp_s = 1e-9 * (decode.stamp_ns(recorded.message) - self.origin_ns)
        try:
            return read(recorded.message, stamp_s)
        except (ShapeError, ValueError) as error:
            self._skip(recorded, str(error))
            return None
        except DataError as error:
            at_s = 1e-9 * (recorded.arrival_ns - self.origin_ns)
            raise DataError(f"{self.path}: {recorded.topic} at {at_s:.3f} s: {error}") from error

    def _skip(self, recorded: Recorded, reason: str) -> None:
        at_s = round(1e-9 * (recorded.arrival_ns - self.origin_ns), 3)
        skipped = self.skipped.setdefault(recorded.topic, Skipped(0, at_s, reason))
        skipped.count += 1
        if skipped.count == 1:
            _log.warning("%s: %s at %.3f s: %s; left out", self.path, recorded.topic, at_s, reason)

    def _readers(self) -> Mapping[str, Callable[[Any, float], Observation | LidarIncrement | None]]:
        return {
            "imu": decode.imu_sample,
            "gnss": decode.gnss_fix,
            "joints": decode.joint_sample,
            "points": decode.lidar_scan,
            "odometry": _Increments(),
        }

    def _check(self, topic: str, kind: str) -> None:
        types = self._source.types
        if topic not in types:
            there = ", ".join(f"{name} ({typ})" for name, typ in sorted(types.items())) or "nothing"
            near = did_you_mean(topic, [name for name, typ in types.items() if typ == TYPES[kind]])
            raise DataError(
                f"{self.path}: no {topic} for {kind}; name another with --topic "
                f"{kind}=…. It holds: {there}{near}"
            )
        if types[topic] != TYPES[kind]:
            raise DataError(
                f"{self.path}: {topic} is {types[topic]}; for {kind}, {TYPES[kind]} is read"
            )


class _Increments:
    """Converts odometry poses to increments, separately for each sensor frame."""

    def __init__(self) -> None:
        self._last: dict[str, tuple[float, Float]] = {}

    def __call__(self, message: Any, stamp_s: float) -> LidarIncrement | None:
        """Return the motion since the frame's last pose; None for the first pose.

        The covariance of the pose is used as that of the increment.
        """
        frame, T = message.child_frame_id, decode.pose_of(message.pose.pose)
        if not np.isfinite(T).all():
            raise ShapeError("a pose with values that are not finite")
        last = self._last.get(frame)
        self._last[frame] = (stamp_s, T)
        if last is None or stamp_s <= last[0]:
            return None
        order = np.r_[3:6, 0:3]  # ROS puts the position first
        covariance = np.array(message.pose.covariance, dtype=float).reshape(6, 6)[
            np.ix_(order, order)
        ]
        if not (np.diag(covariance) > 0).all():
            covariance = np.diag(_INCREMENT_STD**2)
        return LidarIncrement(last[0], stamp_s, frame, inverse(last[1]) @ T, covariance)


def _is_needed(kind: str) -> bool:
    return kind in ("imu", "gnss")
