"""`executive place`: build a structure of a folder of stones in a trial, without a machine."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from executive.commands.console import answer, check_output, one_of, say
from executive.commands.options import JsonOption, SeedOption, SetOption, settings
from executive.errors import ConfigError
from executive.extras import require_extra

if TYPE_CHECKING:
    from executive.commands.walls.construction import PlacedStone

_COURSES = 4
_TRIAL_SITE, _SITE_GROUP = "rigid_stones", "trial_site"


def place(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    stones: Annotated[
        Path, typer.Argument(metavar="STONES", help="Folder of OBJ, PLY or STL meshes.")
    ],
    structure: Annotated[
        Path, typer.Argument(metavar="WALL.yaml", help="What is to be built (docs/walls.md).")
    ],
    method: Annotated[
        str | None, typer.Option(help="Short for --set building.plugin=NAME.")
    ] = None,
    set_: SetOption = None,
    budget: Annotated[
        float | None, typer.Option(min=0.0, help="Processor time for each stone's plan [s].")
    ] = None,
    out: Annotated[Path | None, typer.Option(help="File for all that was done: .json.")] = None,
    pictures: Annotated[
        Path | None, typer.Option(help="Folder for a picture of the structure, course by course.")
    ] = None,
    judge: Annotated[
        str, typer.Option(help="Which judge rates the result; 'none' for no verdict.")
    ] = "rigid_stones",
    seed: SeedOption = 1,
    as_json: JsonOption = False,
) -> None:
    """Build found stones into a wall, in a trial.

    No machine takes part. Each stone is planned on the structure as it stands, let go with noise,
    and measured. Exit status 1 says that no stone was placed.

    Example: executive place scans/ wall.yaml --pictures out/ --out wall.json
    """
    from executive import registry
    from executive.commands.walls.construction import answer_of
    from executive.mission.judging import verdict_of

    check_output("--out", out, ".json")
    one_of("--judge", judge, (registry.NO_JUDGE, *registry.names(registry.JUDGES)))
    if pictures:
        require_extra("--pictures", "viewing")
        if not pictures.is_dir():
            raise ConfigError(f"--pictures: {pictures}: name a folder that exists")
    trial, told = _built(stones, structure, settings(set_, building=method), budget, seed)
    answered: dict[str, Any] = {"seed": seed, "left_out": told, **answer_of(trial)}
    say(f"ended: {trial.reason}; {len(trial.placed)} stones, {answered['right']} where planned")
    if trial.last and trial.last.detail:
        say(f"  {trial.last.detail}")
    if judge != registry.NO_JUDGE and trial.placed:
        answered["verdict"] = dict(verdict_of(trial.built, judge))
        say(
            "\n".join(f"  {name:26} {_short(value)}" for name, value in answered["verdict"].items())
        )
    if pictures and trial.placed:
        from executive.commands.walls.pictures import draw_courses

        for path in draw_courses(pictures, trial.placed, _COURSES):
            say(f"  {path}")
    if out:
        out.write_text(json.dumps(answered, indent=2) + "\n", encoding="utf-8")
    if as_json:
        answer(answered)
    raise typer.Exit(0 if trial.placed else 1)


def _built(
    stones: Path, structure: Path, options: tuple[str, ...], budget: float | None, seed: int
) -> Any:
    """Return the trial, and what was left out of the folder."""
    import numpy as np

    from executive import registry
    from executive.commands.chosen import chosen
    from executive.commands.walls.construction import TrialRules, build
    from executive.commands.walls.stone_folder import read_stones
    from executive.commands.walls.structure_file import read_structure
    from executive.interfaces.building import StructurePlanner
    from executive.tree.choices import Choices

    task = read_structure(structure)
    defaults = {"building": task.planner}
    choices = Choices(("building",), options, defaults, source=str(structure))
    rng = np.random.default_rng(seed)
    inventory, told = read_stones(stones, task.file.stones, rng)
    for name, why in told.items():
        say(f"{name}: {why}")
    say(f"{stones}: {len(inventory)} stones")
    rules = TrialRules((task.file.noise, task.file.tilt_noise), task.file.most, budget)
    site = registry.load(_SITE_GROUP, _TRIAL_SITE)()
    with chosen(StructurePlanner, choices) as planner:
        return build(task.built, inventory, planner, site, rules, rng, _tell), told


def _tell(one: "PlacedStone") -> None:
    degrees = one.error_rad * 57.29578
    say(
        f"  {len(one.built.standing):3}  {one.stone}  off its plan by {one.error_m:.3f} m, "
        f"{degrees:.1f} deg; planned in {one.planning_cpu_s:.1f} s of processor time"
    )


def _short(value: Any) -> str:
    return f"{value:.3f}" if isinstance(value, float) else str(value)
