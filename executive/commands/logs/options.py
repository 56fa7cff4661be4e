"""Options and arguments of the verbs on recorded logs."""

from pathlib import Path
from typing import Annotated

import typer

ODOMETRY = "scan_to_submap"  # missions select none by default; a log with lidar scans gets this one

LogArgument = Annotated[
    Path, typer.Argument(metavar="LOG", help="An .mcap file, a .bag file, or a ROS 2 bag's folder.")
]
DropOption = Annotated[
    list[str] | None,
    typer.Option(
        "--drop",
        metavar="SENSOR:FROM:TO",
        help="Leave a sensor out, seconds since the log began: gnss:120:165.",
    ),
]
OffsetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--offset",
        metavar="SENSOR:SECONDS",
        help="Add to a sensor's stamps, if its clock is behind: gnss:0.08.",
    ),
]
TopicOption = Annotated[
    list[str] | None,
    typer.Option("--topic", metavar="KIND=NAME", help="Name a topic: imu=/car/imu, gnss=/car/fix."),
]
OdometryOption = Annotated[
    str | None,
    typer.Option(
        help="Short for --set odometry.plugin=NAME; --set odometry=[] leaves lidar scans unused."
    ),
]
MachineOption = Annotated[
    str | None, typer.Option(help="Description of the machine; the log's own by default.")
]
LeverOption = Annotated[
    list[str] | None,
    typer.Option(
        "--lever",
        metavar="FRAME:X,Y,Z",
        help="Where a sensor is from the inertial one, in its axes, of a log without tf_static "
        "[m]: gps:0,0,1.2.",
    ),
]
CalibrationOption = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="What `executive calibrate` has written of the sensors."),
]
