"""`executive estimate`: an estimator over a recorded log."""

from pathlib import Path
from typing import Annotated

import typer

from executive.commands.console import answer, say
from executive.commands.logs.options import (
    ODOMETRY,
    DropOption,
    LogArgument,
    MachineOption,
    OdometryOption,
    OffsetOption,
    TopicOption,
)
from executive.commands.options import JsonOption, SetOption, settings
from executive.extras import require_extra

_SMOOTHER = "batch_graph"


def estimate(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    log: LogArgument,
    out: Annotated[Path, typer.Option(help="Trajectory (TUM); report and plot go beside it.")],
    estimator: Annotated[
        str | None, typer.Option(help="Short for --set estimation.plugin=NAME.")
    ] = None,
    drop: DropOption = None,
    offset: OffsetOption = None,
    topic: TopicOption = None,
    machine: MachineOption = None,
    odometry: OdometryOption = None,
    set_: SetOption = None,
    realtime: Annotated[
        bool, typer.Option("--realtime", help="Feed the log at its own pace.")
    ] = False,
    batch: Annotated[
        bool,
        typer.Option("--batch", help="Also smooth the whole log at once, as a reference."),
    ] = False,
    as_json: JsonOption = False,
) -> None:
    """Run an estimator over a recorded log.

    It writes the trajectory, a report and a plot.

    Example: executive estimate run.mcap --out run.tum --set estimation.plugin=dual_graph
    """
    require_extra("executive estimate", "logs")

    from executive.estimate.estimator_run import estimate as run_estimator
    from executive.estimate.files import write_files
    from executive.estimate.material import Material
    from executive.estimate.options import EstimateOptions, log_choices
    from executive.estimate.reference import with_reference

    wanted = settings(set_, estimation=estimator, odometry=odometry)
    plugins = log_choices(wanted, odometry=ODOMETRY)
    options = EstimateOptions(
        machine, topic or (), drop or (), offset or (), plugins, is_realtime=realtime
    )
    name = plugins.name("estimation")
    material = Material.read(log, options)
    estimated = run_estimator(material, name, options)
    if batch:
        estimated = with_reference(material, estimated, _SMOOTHER)
    paths = write_files(out, material, estimated)
    states = len(estimated.track.stamps_s)
    say(f"{name} on {log}: {states} states, {', '.join(map(str, paths))}")
    if as_json:
        answer(estimated.report)
