"""The commands on recorded logs; whatever is heavy is imported inside the command that needs it."""

import json
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

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
    str, typer.Option(help="Odometry plugin for lidar scans; empty to leave them alone.")
]
MachineOption = Annotated[
    str | None, typer.Option(help="Description of the machine; the log's own by default.")
]
JsonOption = Annotated[
    bool, typer.Option("--json", help="Answer on standard output, for machines.")
]

_SMOOTHER = "batch_graph"


def estimate(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    log: LogArgument,
    out: Annotated[Path, typer.Option(help="Trajectory (TUM); report and plot go beside it.")],
    estimator: Annotated[
        str, typer.Option(help="Name of an estimation plugin.")
    ] = "gnss_imu_filter",
    drop: DropOption = None,
    offset: OffsetOption = None,
    topic: TopicOption = None,
    machine: MachineOption = None,
    odometry: OdometryOption = "scan_to_submap",
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="K=V", help="Override a setting of the estimator: lag_s=0.2."
        ),
    ] = None,
    realtime: Annotated[
        bool, typer.Option("--realtime", help="Feed the log at its own pace.")
    ] = False,
    batch: Annotated[
        bool,
        typer.Option(
            "--batch", help="Smooth the whole log at once, too, as a reference to hold it against."
        ),
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Run an estimator over a recorded log: trajectory, report and plot."""
    from executive.estimate.estimator_run import estimate as run_estimator
    from executive.estimate.files import write_files
    from executive.estimate.material import Material
    from executive.estimate.options import EstimateOptions
    from executive.estimate.reference import with_reference

    options = EstimateOptions(
        machine, topic or (), drop or (), offset or (), set_ or (), odometry, realtime
    )
    material = Material.read(log, options)
    estimated = run_estimator(material, estimator, options)
    if batch:
        estimated = with_reference(material, estimated, _SMOOTHER)
    paths = write_files(out, material, estimated)
    _say(
        f"{estimator} on {log}: {len(estimated.track.stamps_s)} states, "
        f"{', '.join(map(str, paths))}"
    )
    if as_json:
        _answer(estimated.report)


def _say(text: str) -> None:
    print(text, file=sys.stderr)


def _answer(value: Any) -> None:
    print(json.dumps(value, indent=2, ensure_ascii=False))
