"""The verb that surveying brings to the command line; whatever is heavy is imported when
it runs.
"""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from executive.errors import ConfigError

if TYPE_CHECKING:
    from executive_plugins.surveying.photogrammetry import Photogrammetry


def survey(
    photographs: Annotated[Path, typer.Argument(help="Folder of a drone's pictures, JPEG or PNG.")],
    out: Annotated[Path, typer.Option(help="PLY file for the cloud, in metres, z up.")],
    positions: Annotated[
        Path | None, typer.Option(help="CSV: name,x,y,z or name,lat,lon,alt.")
    ] = None,
    view_angle: Annotated[
        float | None, typer.Option(help="Opening angle across a picture's width [deg].")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="All chance follows from it.")] = 1,
    as_json: Annotated[
        bool, typer.Option("--json", help="Answer on standard output, for machines.")
    ] = False,
) -> None:
    """Make a drone's photographs into a cloud, on the processor; a minute or two for forty
    pictures.
    """
    import numpy as np
    from executive_plugins.surveying.colmap import FEWEST_PICTURES
    from executive_plugins.surveying.photogrammetry import PhotogrammetrySettings, reconstruct
    from executive_plugins.surveying.photograph_folder import read_photographs
    from executive_plugins.surveying.structure_from_motion import MotionSettings

    from executive.clouds.ply_writer import write_parts

    _refuse(out, view_angle)
    motion = MotionSettings(
        view_angle_rad=None if view_angle is None else float(np.radians(view_angle))
    )
    found = reconstruct(
        read_photographs(photographs, positions, FEWEST_PICTURES),
        PhotogrammetrySettings(motion=motion),
        np.random.default_rng(seed),
    )
    write_parts(out, [found.cloud.points])
    print(_told(found, out), file=sys.stderr)
    if as_json:
        print(json.dumps(_answer(found), indent=2))


def _refuse(out: Path, view_angle_deg: float | None) -> None:
    """Refuse options that a minute's work would end in."""
    if out.suffix.lower() != ".ply" or not out.parent.is_dir():
        raise ConfigError(f"--out: {out}: name a .ply file in a folder that exists")
    if view_angle_deg is not None and not 6 < view_angle_deg < 160:
        raise ConfigError(f"--view-angle: {view_angle_deg:g} is not within 6 to 160 degrees")


def _told(found: "Photogrammetry", out: Path) -> str:
    alignment = found.alignment
    return (
        f"{len(found.names)} of {found.pictures} pictures found their place\n"
        f"  positions  {alignment.residual_m:.2f} m off (RMS), the scale is known to "
        f"±{alignment.scale_error:.1%}\n"
        f"  points     {len(found.cloud)}   {out}"
    )


def _answer(found: "Photogrammetry") -> dict[str, Any]:
    return {
        "pictures": found.pictures,
        "placed": list(found.names),
        "points": len(found.cloud),
        "positions_rms_m": found.alignment.residual_m,
        "positions_used": int(found.alignment.is_used.sum()),
        "scale_error": found.alignment.scale_error,
    }
