"""Options of a run of an estimator on a recorded log."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from executive.estimate.calibration import Calibration
from executive.tree.choices import Choices


def log_choices(options: Sequence[str] = (), **defaults: Any) -> Choices:
    """Return the plugins for a log, with `--set` options laid over the defaults.

    Args:
        options: `capability.field=value` or `capability.plugin=name`.
        defaults: The plugins of a capability where they differ from the shipped missions': a name
            or a list of names.

    Raises:
        MissionFileError: If an option is wrong.
    """
    return Choices(("estimation", "odometry"), options, defaults)


@dataclass(frozen=True, slots=True)
class EstimateOptions:
    """What the command line gives besides the log and the estimator.

    Attributes:
        machine: Name of a machine's description; None for the machine that the log names.
        topics: `KIND=NAME` pairs that replace default topic names.
        drops: `SENSOR:FROM:TO`, outages to simulate by leaving measurements out.
        offsets: `SENSOR:SECONDS`, added to the stamps of a sensor.
        calibration: What `executive calibrate` has found of the sensors; None if it was not run.
        plugins: The estimators and the lidar odometry with their settings; lidar scans are ignored
            if no odometry is chosen.
        is_realtime: Whether to replay at the pace of the recording.
        levers: `FRAME:X,Y,Z`, where sensors are from the inertial one [m], of a log that lacks it.
    """

    machine: str | None = None
    topics: Sequence[str] = ()
    drops: Sequence[str] = ()
    offsets: Sequence[str] = ()
    calibration: Calibration | None = None
    plugins: Choices = field(default_factory=log_choices)
    is_realtime: bool = False
    levers: Sequence[str] = ()
