"""Options of a run of an estimator on a recorded log."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class EstimateOptions:
    """What the command line gives besides the log and the estimator.

    Attributes:
        machine: Name of a machine's description; None for the machine that the log names.
        topics: `KIND=NAME` pairs that replace default topic names.
        drops: `SENSOR:FROM:TO`, outages to simulate by leaving measurements out.
        offsets: `SENSOR:SECONDS`, added to the stamps of a sensor.
        settings: `KEY=VALUE` pairs for the estimator, with dots for nested settings.
        odometry: Name of the lidar odometry plugin; empty to ignore lidar scans.
        is_realtime: Whether to replay at the pace of the recording.
    """

    machine: str | None = None
    topics: Sequence[str] = ()
    drops: Sequence[str] = ()
    offsets: Sequence[str] = ()
    settings: Sequence[str] = ()
    odometry: str = ""
    is_realtime: bool = False
