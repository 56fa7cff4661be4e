"""`executive convert`: a cloud into another file, whole or a part, thinner, or in another frame."""

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from executive.commands.console import answer, say
from executive.commands.options import CloudArgument, JsonOption

if TYPE_CHECKING:
    from executive.clouds.file_cloud import FileCloud


def convert(
    cloud: CloudArgument,
    out: Annotated[Path, typer.Argument(metavar="OUT", help="PLY, PCD, LAS, LAZ or E57 file.")],
    crop: Annotated[
        str | None,
        typer.Option(
            metavar="AREA", help="Keep x,y,radius or x_low,y_low,x_high,y_high alone [m]."
        ),
    ] = None,
    thin: Annotated[
        float | None,
        typer.Option(min=0.001, max=10, help="Keep the first point in each cell of this size [m]."),
    ] = None,
    pose: Annotated[
        str | None,
        typer.Option(
            metavar="POSE",
            help="Move it: x,y,z[,roll,pitch,yaw] (metres, degrees), or a file with a 4×4 matrix "
            "or an answer of register --json or align --json.",
        ),
    ] = None,
    crs: Annotated[
        str | None,
        typer.Option(help="Name of the coordinate system of OUT, such as EPSG:2056."),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Write a cloud in another format.

    PLY, PCD, LAS, LAZ and E57 are written, with colour, intensity and coordinate system.

    A cloud that is moved has the coordinate system that the pose's answer names, or none.

    Example: executive convert site.laz part.laz --crop 2600010,1200020,15 --thin 0.02
    """
    from executive.clouds.point_collector import first_in_cells
    from executive.clouds.reader import read_cloud
    from executive.clouds.writer import write_cloud
    from executive.commands.clouds.crop import Crop
    from executive.commands.clouds.guess import read_guess
    from executive.commands.clouds.output import check_cloud_output

    check_cloud_output("OUT", out, read=(cloud,))
    area = Crop(crop)
    T, scale = read_guess(pose, "--pose")
    whole = read_cloud(cloud)
    part = whole.only(area.inside(whole.points)) if crop else whole
    part = part.only(first_in_cells(part.points, thin)) if thin else part
    part = part.moved(T, scale, _crs_of(pose)) if pose else part
    if crs is not None:
        part = replace(part, place=replace(part.place, crs=crs, records=()))
    changed = write_cloud(out, part)
    for line in (*(f"left out: {name}" for name in part.left_out), *changed):
        say(f"  {line}")
    found = {"points": len(part), "read": len(whole), **_kept(part), "changed": list(changed)}
    say(f"{cloud}: {len(part)} of {len(whole)} points, {_words(found)}, {out}")
    if as_json:
        answer(found)


def _kept(cloud: "FileCloud") -> dict[str, Any]:
    return {
        "crs": cloud.place.crs,
        "colour": cloud.colour is not None,
        "intensity": cloud.intensity is not None,
        "left_out": list(cloud.left_out),
    }


def _words(found: dict[str, Any]) -> str:
    carried = [name for name in ("colour", "intensity") if found[name]]
    return f"with {' and '.join(carried) or 'coordinates alone'}, {found['crs'] or 'no crs'}"


def _crs_of(pose: str) -> str:
    """Return the coordinate system that an answer names; empty if there is none."""
    path = Path(pose)
    try:
        read = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else None
    except (ValueError, RecursionError):  # a matrix of numbers, which names no system
        return ""
    found = read.get("crs", "") if isinstance(read, dict) else ""
    return found if isinstance(found, str) else ""
