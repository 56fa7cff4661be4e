"""`executive grasp`: how a machine would hold a stone of a cloud that a user has."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from executive.commands.console import answer, check_output, say
from executive.commands.options import (
    CloudArgument,
    JsonOption,
    SeedOption,
    SetOption,
    WidestOption,
    settings,
)
from executive.extras import require_extra

if TYPE_CHECKING:
    from executive.commands.grasps.scene import GraspScene
    from executive.messages.grasp import GraspPlan


def grasp(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    cloud: CloudArgument,
    segment: Annotated[
        int, typer.Option(min=0, help="Which stone: its number by `executive segment`.")
    ] = 0,
    method: Annotated[
        str | None, typer.Option(help="Short for --set grasping.plugin=NAME.")
    ] = None,
    widest: WidestOption = None,
    set_: SetOption = None,
    machine: Annotated[
        str | None,
        typer.Option(help="A shipped machine, or a folder with a robot.yaml; m545 by default."),
    ] = None,
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
    seed: SeedOption = 1,
    as_json: JsonOption = False,
) -> None:
    """Plan how to hold a stone of a cloud.

    Grasps are listed best first. Exit status 1 says that the stone cannot be held.

    Example: executive grasp site.ply --segment 2 --picture best.png
    """
    import numpy as np

    from executive.commands.grasps.answer import lines, plan_answer, write_answer
    from executive.commands.grasps.scene import plan_grasps, read_scene
    from executive.tree.choices import Choices

    check_output("--out", out, ".json", ".yaml")
    check_output("--picture", picture, ".png")
    check_output("--record", record, ".rrd")
    if picture:
        require_extra("--picture", "viewing")
    uses = ("segmentation", "grasping", *(("viewing",) if record else ()))
    choices = Choices(uses, settings(set_, grasping=method))
    scene = read_scene(cloud, segment, choices, machine, base, widest)
    plan = plan_grasps(scene, np.random.default_rng(seed))
    answered = plan_answer(plan, segment, scene.T_map_base)
    say(
        f"{cloud}: {len(plan.grasps)} grasps of segment {segment}, "
        f"{len(scene.stone.points_map)} points"
    )
    say("\n".join(lines(plan)))
    if out:
        write_answer(out, answered)
    if picture and plan.grasps:
        _draw(picture, scene, plan, f"{cloud.name}, segment {segment}")
    if record:
        _record(record, scene, plan)
    if as_json:
        answer(answered)
    raise typer.Exit(0 if plan.grasps else 1)


def _draw(path: Path, scene: "GraspScene", plan: "GraspPlan", title: str) -> None:
    from executive.commands.grasps.picture import draw_grasp

    stone, cloud, gripper = scene.stone.points_map, scene.cloud.points, scene.machine.gripper
    title = f"{title}: best of {len(plan.grasps)} grasps"
    draw_grasp(path, plan.grasps[0], stone, cloud, gripper, title)


def _record(path: Path, scene: "GraspScene", plan: "GraspPlan") -> None:
    """Write a recording in which one second of time is one grasp, the best first."""
    from executive.commands.chosen import chosen
    from executive.interfaces.viewing import Viewer

    with chosen(Viewer, scene.choices, scene.model) as viewer:
        viewer.open(str(path))
        viewer.show(0.0, "map", scene.cloud)
        viewer.show(0.0, "stones/1", scene.stone)
        for number, one in enumerate(plan.grasps):
            viewer.show(float(number), "grasp", one)
