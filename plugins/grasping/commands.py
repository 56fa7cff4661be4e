"""The commands that grasping adds to the command line; heavy imports are deferred to a call."""

import math
from pathlib import Path
from typing import Annotated, get_args

import typer
from executive_plugins.physics.scenario import Scenario

from executive.commands.bulk import Where, spread
from executive.commands.console import answer, one_of, say
from executive.errors import ConfigError
from executive.extras import require_extra

_Seed = Annotated[
    int, typer.Option(min=0, help="Seed of all random numbers; equal seeds give equal results.")
]


def grasp_data(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    folder: Annotated[Path, typer.Argument(help="Folder of the labels; existing ones are kept.")],
    stones: Annotated[
        int, typer.Option(min=1, help="Number of stones, existing ones included.")
    ] = 600,
    grasps: Annotated[int, typer.Option(min=2, help="Number of simulated lifts per stone.")] = 24,
    seed: _Seed = 1,
    machine: Annotated[
        str, typer.Option(help="Machine whose gripper lifts: name or folder.")
    ] = "m545",
    physics: Annotated[
        str, typer.Option(help="Contacts of the lifts: kind, nominal, wet or harsh.")
    ] = "kind",
    arm_error_m: Annotated[
        float, typer.Option(help="Largest error of the gripper along each axis [m].")
    ] = 0.05,
    arm_error_deg: Annotated[
        float, typer.Option(help="The same of its attitude about each axis [deg].")
    ] = 5.0,
    weights: Annotated[
        str, typer.Option(help="Network whose first choices are lifted too: name or file.")
    ] = "",
    workers: Annotated[int, typer.Option(min=1, help="Number of parallel processes.")] = 1,
    scheduler: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Use the workers of a dask scheduler: tcp://…"),
    ] = None,
    views: Annotated[
        str, typer.Option(help="How stones are seen: mixed, or surveyed as in missions.")
    ] = "mixed",
    volume_m3: Annotated[
        tuple[float, float], typer.Option(help="Least and largest volume of a stone [m³].")
    ] = (0.1, 1.1),
) -> None:
    """Make labels for grasp classifiers.

    Generated stones are lifted in simulation, as they are seen under noise. What was interrupted
    goes on with the same command. Exit status: 1 if a stone failed, or if it was stopped.

    Example: executive grasp-data labels --stones 600 --workers 2
    """
    from executive_plugins.grasping.learning.labels import LabelSettings, claim, stone_file
    from executive_plugins.grasping.learning.training_scene import Views

    one_of("--physics", physics, get_args(Scenario))
    one_of("--views", views, get_args(Views))
    if not volume_m3[0] <= volume_m3[1]:
        raise ConfigError(f"--volume-m3: expected LEAST MOST, got {volume_m3[0]} {volume_m3[1]}")
    settings = LabelSettings.model_validate(
        {
            "machine": machine,
            "seed": seed,
            "grasps_per_stone": grasps,
            "physics": physics,
            "views": views,
            "volume_m3": volume_m3,
            "arm_error_m": arm_error_m,
            "arm_error_rad": math.radians(arm_error_deg),
            "weights": weights,
        }
    )
    claim(folder, settings)
    missing = [index for index in range(stones) if not stone_file(folder, index).exists()]
    done = stones - len(missing)

    def take(index: int, made: Path) -> None:
        nonlocal done
        stone_file(made, index).replace(stone_file(folder, index))
        done += 1
        say(f"\r{done} of {stones} stones", end="")

    say(f"\r{done} of {stones} stones", end="")
    where = Where(folder / "unfinished", workers, scheduler)
    status = spread("grasp_labels", settings.model_dump(mode="json"), missing, where, take)
    say(f"\n  labels     {folder}")
    raise typer.Exit(status)


def grasp_train(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    folder: Annotated[Path, typer.Argument(help="Folder of labels, from grasp-data.")],
    out: Annotated[Path, typer.Argument(help="Weights file to write (.safetensors).")],
    architecture: Annotated[
        str, typer.Option(help="two_stream, or four_layer (the paper's).")
    ] = "two_stream",
    epochs: Annotated[int, typer.Option(min=1, help="Passes over the labels.")] = 12,
    start: Annotated[
        str, typer.Option(help="Weights to go on from: name or file; new ones by default.")
    ] = "",
    rate: Annotated[float, typer.Option(help="Largest learning rate.")] = 1e-3,
    test: Annotated[
        Path | None, typer.Option(help="Labels of other stones, for a final test.")
    ] = None,
    seed: _Seed = 1,
) -> None:
    """Train a grasp classifier.

    Its data card is printed, and is also in the file.

    Example: executive grasp-train labels net.safetensors --test unseen
    """
    one_of("--architecture", architecture, ("four_layer", "two_stream"))

    require_extra("executive grasp-train", "learning")

    from executive_plugins.grasping.learning.grasp_training import train_weights
    from executive_plugins.grasping.learning.training import Progress, TrainingSettings

    settings = TrainingSettings.model_validate(
        {
            "architecture": architecture,
            "start": start,
            "epochs": epochs,
            "rate": rate,
            "seed": seed,
        }
    )

    def say_progress(progress: Progress) -> None:
        figures = f"loss {progress.loss:.3f}, AUC {progress.auc:.3f}"
        say(f"epoch {progress.epoch} of {epochs}: {figures}")

    answer(train_weights(folder, out, settings, test, say_progress))
