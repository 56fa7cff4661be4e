"""`executive compare-estimators`: estimators side by side, on a log or on a mission that is run for
it.
"""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import typer

from executive.commands.console import answer
from executive.commands.logs.options import (
    ODOMETRY,
    CalibrationOption,
    DropOption,
    LeverOption,
    MachineOption,
    OdometryOption,
    OffsetOption,
    TopicOption,
)
from executive.commands.options import JsonOption, SeedOption, SetOption, settings
from executive.extras import require_extra

MaterialArgument = Annotated[
    Path,
    typer.Argument(
        metavar="LOG|MISSION", help="A log as of `estimate`, or a mission's file or name."
    ),
]


def compare_estimators(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    material: MaterialArgument,
    estimator: Annotated[
        list[str] | None, typer.Option(help="Which to compare; all that are installed.")
    ] = None,
    drop: DropOption = None,
    offset: OffsetOption = None,
    topic: TopicOption = None,
    machine: MachineOption = None,
    odometry: OdometryOption = None,
    calibration: CalibrationOption = None,
    seed: SeedOption = 1,
    set_: SetOption = None,
    as_json: JsonOption = False,
    lever: LeverOption = None,
) -> None:
    """Compare estimators on a log or a mission.

    With a mission, --set changes the mission. With a log it changes the estimators, each by its
    name: --set estimation.dual_graph.gate=30.

    Example: executive compare-estimators run.mcap --estimator dual_graph --drop gnss:20:40
    """
    require_extra("executive compare-estimators", "logs")

    from executive.commands.logs.recorded_mission import compare_on, is_mission, record_mission
    from executive.estimate.calibration import read_calibration
    from executive.estimate.compare import compare, table
    from executive.estimate.material import Material
    from executive.estimate.options import EstimateOptions, log_choices
    from executive.registry import installed

    names = estimator or [plugin.name for plugin in installed("estimation")]
    is_run = is_mission(material)
    wanted = settings(None if is_run else set_, odometry=odometry)
    plugins = log_choices(wanted, odometry=ODOMETRY, estimation=list(names))
    known = None if calibration is None else read_calibration(calibration)
    options = EstimateOptions(
        machine, topic or (), drop or (), offset or (), known, plugins, levers=lever or ()
    )
    if is_run:
        with TemporaryDirectory() as folder:
            recorded = record_mission(str(material), set_ or (), seed, Path(folder))
            reports = compare_on(recorded, names, options)
    else:
        reports = compare(Material.read(material, options), names, options)
    if as_json:
        answer(reports)
    else:
        print(table(reports))
