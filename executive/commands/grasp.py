"""`executive grasp`: how a machine would hold a stone of a cloud that a user has."""

import json
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from executive.commands.single_clouds import JsonOption


def grasp(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    cloud: Annotated[
        Path,
        typer.Argument(metavar="CLOUD", help="PLY, PCD, LAS, LAZ or XYZ file, in metres, z up."),
    ],
    segment: Annotated[
        int, typer.Option(min=0, help="Which stone: its number by `executive segment`.")
    ] = 0,
    method: Annotated[str | None, typer.Option(help="Name of a grasping plugin.")] = None,
    machine: Annotated[
        str, typer.Option(help="A shipped machine, or a folder with a robot.yaml.")
    ] = "m545",
    base: Annotated[
        tuple[float, float, float] | None,
        typer.Option(
            metavar="X Y YAW",
            help="Where the machine stands [m, m, deg]; beside the stone by default.",
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option(help="File for all grasps: .json or .yaml.")] = None,
    picture: Annotated[
        Path | None, typer.Option(help="PNG file for a picture of the best grasp.")
    ] = None,
    record: Annotated[
        Path | None, typer.Option(help="Recording for the rerun viewer: .rrd.")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="All chance follows from it.")] = 1,
    as_json: JsonOption = False,
) -> None:
    """Plan how to hold a stone of a cloud, best first; status 1 if it cannot be held, with the
    reasons.
    """
    import numpy as np

    from executive.commands.grasp_answer import answer, lines, write_answer
    from executive.commands.grasp_scene import plan_grasps, read_scene

    for path, kinds in ((out, (".json", ".yaml")), (picture, (".png",)), (record, (".rrd",))):
        _check(path, kinds)
    scene = read_scene(cloud, segment, machine, base)
    plan = plan_grasps(scene, method, np.random.default_rng(seed))
    answered = answer(plan, segment, scene.T_map_base)
    _say(
        f"{cloud}: {len(plan.grasps)} grasps of segment {segment}, "
        f"{len(scene.stone.points_map)} points"
    )
    _say("\n".join(lines(plan)))
    if out:
        write_answer(out, answered)
    if picture and plan.grasps:
        from executive.commands.grasp_picture import draw_grasp

        best, title = (
            plan.grasps[0],
            f"{cloud.name}, segment {segment}: best of {len(plan.grasps)} grasps",
        )
        draw_grasp(
            picture, best, scene.stone.points_map, scene.cloud.points, scene.machine.gripper, title
        )
    if record:
        _record(record, scene, plan)
    if as_json:
        print(json.dumps(answered, indent=2))
    raise typer.Exit(0 if plan.grasps else 1)


def _record(path: Path, scene: Any, plan: Any) -> None:
    from executive.commands.plugin_choice import chosen

    with chosen("viewing", None, scene.model) as viewer:
        viewer.open(str(path))
        viewer.show(0.0, "map", scene.cloud)
        viewer.show(0.0, "stones/1", scene.stone)
        for number, one in enumerate(
            plan.grasps
        ):  # scrubbed like time: one grasp a second, the best first
            viewer.show(float(number), "grasp", one)


def _check(path: Path | None, kinds: tuple[str, ...]) -> None:
    from executive.errors import ConfigError

    if path and (path.suffix.lower() not in kinds or not path.parent.is_dir()):
        raise ConfigError(f"{path}: name a {' or '.join(kinds)} file in a folder that exists")


def _say(text: str) -> None:
    print(text, file=sys.stderr)
