"""A trajectory that somebody else made, as a reference: TUM files, and poses in logs."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from executive.arrays import Bool, Float
from executive.errors import ConfigError, DataError
from executive.logs import decode
from executive.logs.log_source import LogSource

_LOGS = (".mcap", ".bag", ".db3")
_TUM = "stamp x y z qx qy qz qw"
# What holds a pose, and where in the message it is.
_POSES: Mapping[str, tuple[str, ...]] = {
    "nav_msgs/msg/Odometry": ("pose", "pose"),
    "geometry_msgs/msg/PoseStamped": ("pose",),
    "geometry_msgs/msg/PoseWithCovarianceStamped": ("pose", "pose"),
}
_MISSED = 2.5  # usual intervals between two poses beyond which there is none in between


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """Poses over time, at least two, with stamps that increase.

    Attributes:
        stamps_s: Times since 1970 [s], shape (n,).
        p: Positions [m], shape (n, 3).
        R: Orientations, shape (n, 3, 3).
    """

    stamps_s: Float
    p: Float
    R: Float

    @property
    def has_orientation(self) -> bool:
        """Whether the orientations differ; files of positions repeat one."""
        return bool(np.ptp(self.R, axis=0).max() > 1e-9)

    def covers(self, stamps_s: Float) -> Bool:
        """Return at which times there is a pose shortly before and after, shape (m,)."""
        after = np.searchsorted(self.stamps_s, stamps_s)
        inside = (after > 0) & (after < len(self.stamps_s))
        after = np.clip(after, 1, len(self.stamps_s) - 1)
        steps_s = np.diff(self.stamps_s)
        return np.asarray(inside & (steps_s[after - 1] <= _MISSED * np.median(steps_s)))

    def at(self, stamps_s: Float) -> "Trajectory":
        """Return the poses at times that it covers, interpolated between two."""
        p = np.column_stack([np.interp(stamps_s, self.stamps_s, self.p[:, i]) for i in range(3)])
        turn = Slerp(self.stamps_s, Rotation.from_matrix(self.R))
        return Trajectory(stamps_s, p, turn(stamps_s).as_matrix())


def read_trajectory(path: Path, topic: str | None) -> Trajectory:
    """Read a reference.

    Args:
        path: A TUM file, or a log that holds poses.
        topic: Topic of the poses in a log; None if there is only one.

    Raises:
        DataError: If it cannot be read, or holds no trajectory.
        ConfigError: If the topic is wrong, or one must be named.
    """
    is_log = path.is_dir() or path.suffix in _LOGS
    if topic is not None and not is_log:
        raise ConfigError(f"--score-topic {topic}: {path} is no log; leave the option out")
    rows = _from_log(LogSource(path), topic) if is_log else _from_tum(path)
    rows = rows[np.argsort(rows[:, 0], kind="stable")]
    rows = rows[np.diff(rows[:, 0], prepend=-np.inf) > 0]
    if len(rows) < 2:
        raise DataError(f"{path}: {len(rows)} poses; a reference needs two at least")
    return Trajectory(rows[:, 0], rows[:, 1:4], Rotation.from_quat(rows[:, 4:]).as_matrix())


def _from_tum(path: Path) -> Float:
    rows = []
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is no text"
        raise DataError(f"{path} cannot be read as a TUM file ({_TUM}): {reason}") from error
    for number, line in enumerate(lines, start=1):
        if line.strip() and not line.startswith("#"):
            rows.append(_row(line, f"{path}:{number}"))
    return np.array(rows).reshape(-1, 8)


def _row(line: str, place: str) -> Float:
    try:
        row = np.array([float(word) for word in line.split()])
    except ValueError:
        row = np.empty(0)
    if row.shape != (8,) or not np.isfinite(row).all():
        raise DataError(f"{place}: expected eight numbers ({_TUM}), separated by spaces")
    if not 0.9 < np.linalg.norm(row[4:]) < 1.1:
        raise DataError(
            f"{place}: a quaternion of length {np.linalg.norm(row[4:]):.3g}; it must be 1"
        )
    return row


def _from_log(source: LogSource, topic: str | None) -> Float:
    there = [name for name, kind in source.types.items() if kind in _POSES]
    if topic is None and len(there) == 1:
        topic = there[0]
    if topic not in there:
        found = ", ".join(sorted(there)) or "none"
        wanted = "--score-topic names no topic of poses" if topic else "name one by --score-topic"
        raise ConfigError(f"{source.path}: {wanted}; topics of poses there: {found}")
    rows = []
    for recorded in source.messages([topic]):
        pose = recorded.message
        for name in _POSES[source.types[topic]]:
            pose = getattr(pose, name)
        T = decode.pose_of(pose)
        quaternion = Rotation.from_matrix(T[:3, :3]).as_quat()
        rows.append([1e-9 * decode.stamp_ns(recorded.message), *T[:3, 3], *quaternion])
    return np.array(rows).reshape(-1, 8)
