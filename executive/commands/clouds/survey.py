"""`executive survey`: a drone's photographs to a cloud."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from executive.commands.console import answer, say
from executive.commands.options import JsonOption, SeedOption, SetOption
from executive.errors import ConfigError

if TYPE_CHECKING:
    from executive.config import Settings

_ORIGIN = ("origin_x_m", "origin_y_m", "origin_z_m")  # of a plugin that knows its coordinates
_DEFAULT = "colmap"  # missions survey a simulated site by default; this verb has photographs


def survey(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    photographs: Annotated[
        Path, typer.Argument(metavar="PHOTOGRAPHS", help="Folder of pictures, JPEG or PNG.")
    ],
    out: Annotated[
        Path, typer.Option(help="PLY, PCD, LAS, LAZ or E57 file for the cloud, in metres, z up.")
    ],
    positions: Annotated[
        Path | None, typer.Option(help="CSV of camera positions: name,x,y,z or name,lat,lon,alt.")
    ] = None,
    view_angle: Annotated[
        float | None, typer.Option(help="Opening angle across a picture's width [deg].")
    ] = None,
    set_: SetOption = None,
    crs: Annotated[
        str | None,
        typer.Option(help="Coordinate system of positions in x,y,z, such as EPSG:2056."),
    ] = None,
    seed: SeedOption = 1,
    as_json: JsonOption = False,
) -> None:
    """Make a cloud from a drone's photographs.

    The cloud is metric as far as the positions of the pictures are, and in their coordinates if
    they are x,y,z. Forty pictures of 12 megapixels
    take some minutes on two cores. What is done is kept beside OUT until the end, in a
    folder that ends with .work: the same command goes on where it was cut off.

    Example: executive survey photographs --out survey.ply --set surveying.voxel_m=0.03
    """
    import numpy as np

    from executive.clouds.file_cloud import Place
    from executive.clouds.ply_writer import coloured_parts
    from executive.clouds.writer import write_cloud
    from executive.commands.chosen import chosen
    from executive.commands.clouds.output import check_cloud_output
    from executive.interfaces.surveying import Survey
    from executive.tree.choices import Choices

    check_cloud_output("--out", out)
    given = _given(photographs, positions, view_angle)

    def known(model: type["Settings"]) -> Mapping[str, Any]:
        kept = {"work": str(out.with_suffix(".work"))} if "work" in model.model_fields else {}
        return {**_known(model, given), **kept}

    choices = Choices(("surveying",), set_ or (), {"surveying": _DEFAULT})
    with chosen(Survey, choices, known={"surveying": known}) as plugin:
        if crs is not None and not plugin.account().keys() >= set(_ORIGIN):
            raise ConfigError(
                "--crs: the positions are not in x,y,z, and nothing is projected: give them in "
                f"{crs}"
            )
        plugin.follow(lambda line: say(f"  {line}"))
        cloud = plugin.survey(np.random.default_rng(seed))
        account = dict(plugin.account())
    origin = np.array([account.get(name, 0.0) for name in _ORIGIN], dtype=float)
    write_cloud(out, coloured_parts([cloud.points + origin], Place(crs or "")))
    for name, figure in account.items():
        say(f"  {name:16} {', '.join(figure) if isinstance(figure, tuple) else figure}")
    say(f"{photographs}: {len(cloud)} points, {out}")
    if as_json:
        answer({"points": len(cloud), "crs": crs or "", **account})


def _given(
    photographs: Path, positions: Path | None, view_angle_deg: float | None
) -> dict[str, Any]:
    """Return what the command line says as settings of a plugin that takes photographs."""
    given: dict[str, Any] = {"photographs": str(photographs)}
    if positions is not None:
        given["positions"] = str(positions)
    if view_angle_deg is not None:
        if not 6 < view_angle_deg < 160:
            raise ConfigError(f"--view-angle: {view_angle_deg:g} is not within 6 to 160 degrees")
        given["motion"] = {"view_angle_rad": math.radians(view_angle_deg)}
    return given


def _known(model: type["Settings"], given: Mapping[str, Any]) -> Mapping[str, Any]:
    strange = [name for name in given if name not in model.model_fields]
    if strange:
        raise ConfigError(
            f"{model.__name__} has no setting '{strange[0]}': choose a surveying plugin that takes "
            f"photographs, such as --set surveying.plugin={_DEFAULT}"
        )
    return given
