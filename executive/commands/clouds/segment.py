"""`executive segment`: the objects on the ground of a cloud."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from executive.commands.console import answer, check_output, say
from executive.commands.options import CloudArgument, JsonOption, SetOption, settings

if TYPE_CHECKING:
    from executive.messages.segment import LeftOut, Segment, Segmentation


def segment(
    cloud: CloudArgument,
    method: Annotated[
        str | None, typer.Option(help="Short for --set segmentation.plugin=NAME.")
    ] = None,
    set_: SetOption = None,
    out: Annotated[
        Path | None, typer.Option(help="PLY file to write the segments to, one colour each.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Find the objects on the ground of a cloud.

    What else rises from the ground is told with the reason why it is no stone.

    Exit status 1 says that there is none.

    Example: executive segment site.ply --out stones.ply
    """
    from executive.clouds.ply_writer import write_parts
    from executive.clouds.reader import read_site
    from executive.commands.chosen import chosen
    from executive.interfaces.segmentation import Segmenter
    from executive.messages.cloud import Cloud
    from executive.tree.choices import Choices

    check_output("--out", out, ".ply")
    choices = Choices(("segmentation",), settings(set_, segmentation=method))
    with chosen(Segmenter, choices) as segmenter:
        points = read_site(cloud)
        found = segmenter.segment(Cloud(cloud.stem, points))
    for one in found.segments:
        say(_line(one))
    for rest in found.left_out:
        say(_rest_line(rest))
    if found.scattered_points:
        say(f"  left out: {found.scattered_points} points above the ground in tiny clusters")
    for warning in found.warnings:
        say(f"warning: {warning}")
    say(f"{cloud}: {len(found.segments)} segments of {len(points)} points")
    if out:
        write_parts(out, [one.points for one in found.segments])
    if as_json:
        answer(_answer(found))
    if not found.segments:
        say("nothing to use: no stone was found")
        raise typer.Exit(1)


def _line(one: "Segment") -> str:
    centre, size = (" ".join(f"{x:.2f}" for x in values) for values in (one.centroid, one.extents))
    return f"  {one.id:3}  {len(one.points):7} points at {centre} m, {size} m long"


def _rest_line(one: "LeftOut") -> str:
    centre = " ".join(f"{x:.2f}" for x in one.centroid)
    return f"  left out: {one.kind}, {one.points} points at {centre} m, {one.reason}"


def _answer(found: "Segmentation") -> dict[str, Any]:
    segments = [
        {
            "id": one.id,
            "points": len(one.points),
            "centroid": one.centroid.tolist(),
            "extents": one.extents.tolist(),
        }
        for one in found.segments
    ]
    left_out = [
        {
            "kind": str(one.kind),
            "reason": one.reason,
            "points": one.points,
            "centroid": one.centroid.tolist(),
            "extents": one.extents.tolist(),
        }
        for one in found.left_out
    ]
    return {
        "segments": segments,
        "ground_plane": found.ground_plane.tolist(),
        "left_out": left_out,
        "scattered_points": found.scattered_points,
        "warnings": list(found.warnings),
    }
