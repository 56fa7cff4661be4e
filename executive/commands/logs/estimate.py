"""`executive estimate`: an estimator over a recorded log."""

from pathlib import Path
from typing import Annotated

import typer

from executive.commands.console import answer, check_writable, one_of, say
from executive.commands.logs.options import (
    ODOMETRY,
    CalibrationOption,
    DropOption,
    LeverOption,
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
    calibration: CalibrationOption = None,
    set_: SetOption = None,
    realtime: Annotated[
        bool, typer.Option("--realtime", help="Feed the log at its own pace.")
    ] = False,
    batch: Annotated[
        bool,
        typer.Option("--batch", help="Also smooth the whole log at once, as a reference."),
    ] = False,
    score: Annotated[
        Path | None,
        typer.Option(
            metavar="REFERENCE",
            help="Compare with a reference: a TUM file, or a log that holds poses.",
        ),
    ] = None,
    align: Annotated[
        str,
        typer.Option(help="How the reference is laid over the estimate: none, yaw or se3."),
    ] = "none",
    score_topic: Annotated[
        str | None, typer.Option(metavar="NAME", help="Topic of the poses in a reference log.")
    ] = None,
    export: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="Also write states with velocity and covariance: .csv, or .mcap (nav_msgs).",
        ),
    ] = None,
    as_json: JsonOption = False,
    lever: LeverOption = None,
) -> None:
    """Run an estimator over a recorded log.

    It writes the trajectory, a report and a plot. With --score the report holds absolute and
    relative errors against a reference of the cabin (or the only body), and how far the covariance
    is kept.

    Example: executive estimate run.mcap --out run.tum --score truth.tum --align yaw
    """
    require_extra("executive estimate", "logs")

    from executive.estimate.calibration import read_calibration
    from executive.estimate.estimator_run import estimate as run_estimator
    from executive.estimate.files import names_of, write_files
    from executive.estimate.material import Material
    from executive.estimate.odometry_file import check_format
    from executive.estimate.options import EstimateOptions, log_choices
    from executive.estimate.reference import with_reference
    from executive.estimate.score import ALIGNMENTS, summary, with_score
    from executive.estimate.trajectory import read_trajectory

    one_of("--align", align, ALIGNMENTS)
    exports = export or ()
    for path in exports:
        check_format(path)
    for path in names_of(out, exports, is_smoothed=batch):
        option = "--export" if path in exports else "--out"
        check_writable(option, path, (log, score, calibration))
    reference = None if score is None else read_trajectory(score, score_topic)
    wanted = settings(set_, estimation=estimator, odometry=odometry)
    plugins = log_choices(wanted, odometry=ODOMETRY)
    known = None if calibration is None else read_calibration(calibration)
    options = EstimateOptions(
        machine,
        topic or (),
        drop or (),
        offset or (),
        known,
        plugins,
        is_realtime=realtime,
        levers=lever or (),
    )
    name = plugins.name("estimation")
    material = Material.read(log, options)
    estimated = run_estimator(material, name, options)
    if batch:
        estimated = with_reference(material, estimated, _SMOOTHER)
    if reference is not None:
        estimated = with_score(material, estimated, reference, align)
    paths = write_files(out, material, estimated, exports)
    states = len(estimated.track.stamps_s)
    say(f"{name} on {log}: {states} states, {', '.join(map(str, paths))}")
    if reference is not None:
        say(summary(estimated.report["score"]))
    if as_json:
        answer(estimated.report)
