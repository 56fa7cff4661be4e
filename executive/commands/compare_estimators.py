"""The command that lays estimators side by side, on a recorded log or on a mission that it runs for
that.
"""

import json
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import typer

from executive.commands.estimate import (
    DropOption,
    JsonOption,
    MachineOption,
    OdometryOption,
    OffsetOption,
    TopicOption,
)

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
    odometry: OdometryOption = "scan_to_submap",
    seed: Annotated[int, typer.Option(min=0, help="Of the mission.")] = 1,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="K=V", help="Override a setting of the mission."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Run estimators over one log, or over one run of a mission, and lay their figures side by
    side.
    """
    from executive.commands.recorded_mission import compare_on, is_mission, rehearse
    from executive.estimate.compare import compare, table
    from executive.estimate.material import Material
    from executive.estimate.options import EstimateOptions
    from executive.registry import installed

    options = EstimateOptions(machine, topic or (), drop or (), offset or (), odometry=odometry)
    names = estimator or [plugin.name for plugin in installed("estimation")]
    if is_mission(material):
        with TemporaryDirectory() as folder:
            reports = compare_on(
                rehearse(str(material), set_ or (), seed, Path(folder)), names, options
            )
    else:
        reports = compare(Material.read(material, options), names, options)
    print(json.dumps(reports, indent=2, ensure_ascii=False) if as_json else table(reports))
