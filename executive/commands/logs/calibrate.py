"""`executive calibrate`: clocks, mounting and noise of a log's sensors."""

from pathlib import Path
from typing import Annotated

import typer

from executive.commands.console import answer, check_output, say
from executive.commands.logs.options import (
    ODOMETRY,
    LeverOption,
    LogArgument,
    MachineOption,
    TopicOption,
)
from executive.commands.options import JsonOption, settings
from executive.extras import require_extra

_CALIBRATOR = "keyframe_batch"


def calibrate(
    log: LogArgument,
    out: Annotated[Path, typer.Option(help="The calibration file (.yaml) that is written.")],
    topic: TopicOption = None,
    machine: MachineOption = None,
    odometry: Annotated[
        str | None,
        typer.Option(help=f"Plugin that measures motion by lidar scans; {ODOMETRY} by default."),
    ] = None,
    as_json: JsonOption = False,
    lever: LeverOption = None,
) -> None:
    """Find clocks, mounting and noise of sensors.

    How a log's sensors are mounted, how far their clocks are off, and how noisy they are.

    Each figure is told with its standard deviation. What the motion does not show is not written;
    the answer says which motion would. Exit status 1: no clock and no mounting was found.

    Example: executive calibrate run.mcap --out rig.yaml
    """
    require_extra("executive calibrate", "logs")

    from executive.estimate.calibrate import (
        calibrated,
        is_any_found,
        lines,
        report,
        write_calibration,
    )
    from executive.estimate.material import Material
    from executive.estimate.options import EstimateOptions, log_choices

    check_output("--out", out, ".yaml", ".yml")
    plugins = log_choices(settings(None, odometry=odometry), odometry=ODOMETRY)
    options = EstimateOptions(machine, topic or (), plugins=plugins, levers=lever or ())
    material = Material.read(log, options)
    quantities = calibrated(material, _CALIBRATOR)
    for line in lines(quantities):
        say(line)
    write_calibration(out, log, quantities)
    is_found = is_any_found(quantities)
    say(f"{out}: for executive estimate {log} --calibration {out}")
    if not is_found:
        say("no clock and no mounting was found: the motion does not show them")
    if as_json:
        answer(report(material, _CALIBRATOR, quantities))
    if not is_found:
        raise typer.Exit(1)
