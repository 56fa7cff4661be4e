"""`executive segment`: the objects on the ground of a cloud."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from executive.commands.clouds.view import (
    ViewOption,
    check_view,
    near_origin,
    recording_of,
    shifted,
    show,
)
from executive.commands.console import answer, say
from executive.commands.options import CropOption, JsonOption, SetOption, WidestOption, settings
from executive.errors import DataError

if TYPE_CHECKING:
    from executive.arrays import Float
    from executive.commands.clouds.crop import Crop
    from executive.commands.clouds.earlier import EarlierCloud
    from executive.interfaces.segmentation import Segmenter
    from executive.messages.cloud import Cloud
    from executive.messages.segment import LeftOut, Segment, Segmentation


def segment(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    cloud: Annotated[
        Path,
        typer.Argument(
            metavar="CLOUD",
            help="PLY, PCD, LAS, LAZ, E57 or XYZ file, metres, z roughly up; or a folder of them.",
        ),
    ],
    method: Annotated[
        str | None, typer.Option(help="Short for --set segmentation.plugin=NAME.")
    ] = None,
    set_: SetOption = None,
    crop: CropOption = None,
    widest: WidestOption = None,
    earlier: Annotated[
        Path | None,
        typer.Option(
            metavar="CLOUD",
            help="An earlier cloud of the site in the same coordinates: what stands where it shows "
            "lower ground is told as moving.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="PLY, PCD, LAS, LAZ or E57 file for the segments, one colour each; of a folder "
            "of clouds, a folder, which is gone on with."
        ),
    ] = None,
    as_json: JsonOption = False,
    view: ViewOption = False,
) -> None:
    """Find stones in a cloud, or in those of a folder.

    What else rises from the ground is told with the reason why it is no stone.

    Exit status 1 says that there is none, or that a cloud of the folder could not be used.

    Example: executive segment site.ply --out stones.ply
    """
    from executive.commands.chosen import chosen
    from executive.commands.clouds.crop import Crop
    from executive.commands.clouds.earlier import EarlierCloud
    from executive.commands.clouds.folder import Batch, check_batch, each_of
    from executive.commands.clouds.output import check_cloud_output
    from executive.interfaces.segmentation import Segmenter
    from executive.tree.choices import Choices

    area = Crop(crop)
    check_view(view)
    read = () if earlier is None else (earlier,)
    if not cloud.is_dir():
        check_cloud_output("--out", out, read=(cloud, *read))
    else:
        check_batch(cloud, out, as_json, view)
    set_words = settings(set_, segmentation=method)
    choices = Choices(("segmentation",), set_words)
    with chosen(Segmenter, choices) as segmenter:
        before = None if earlier is None else EarlierCloud(earlier, widest)
        work = partial(_segmented, partial(_found, segmenter, area, widest, before))
        if cloud.is_dir():
            asked = {"set": list(set_words), "crop": crop, "widest": widest, **_asked(earlier)}
            status = each_of(Batch(cloud, out, asked, "segments", read), work)
        else:
            found = work(cloud, out, view)
            status = int(not found["segments"])
            if as_json:
                answer(found)
            if status:
                say("nothing to use: no stone was found")
    raise typer.Exit(status)


def _asked(earlier: Path | None) -> dict[str, str]:
    return {} if earlier is None else {"earlier": str(earlier.resolve())}


def _found(
    segmenter: "Segmenter", area: "Crop", widest_m: float | None, before: "EarlierCloud | None",
    path: Path, points: "Float",
) -> "tuple[Cloud, Segmentation]":  # fmt: skip
    """Return the part of a file's points in the area [m], and its segmentation.

    Raises:
        DataError: If there is nothing to segment; the file is named.
    """
    cloud = area.of_site(path, path.stem, points, widest_m)
    try:
        found = segmenter.segment(cloud)
        return cloud, found if before is None else before.with_moving(found, cloud.points)
    except DataError as error:
        raise DataError(f"{path}: {error}") from error


def _segmented(
    find: "Callable[[Path, Float], tuple[Cloud, Segmentation]]",
    path: Path,
    out: Path | None,
    is_shown: bool = False,
) -> dict[str, Any]:
    """Segment one file, tell what was found, write and show the segments, and return the answer."""
    from executive.clouds.ply_writer import coloured_parts
    from executive.clouds.reader import read_cloud
    from executive.clouds.writer import write_cloud
    from executive.messages.cloud import Cloud

    site = read_cloud(path)
    points, found = find(path, site.points)
    for one in found.segments:
        say(_line(one))
    for rest in found.left_out:
        say(_rest_line(rest))
    if found.scattered_points:
        say(f"  left out: {found.scattered_points} points above the ground in tiny clusters")
    for warning in found.warnings:
        say(f"warning: {warning}")
    say(f"{path}: {len(found.segments)} segments of {len(points)} points")
    if out and (found.segments or out.suffix.lower() == ".ply"):  # others hold a point at least
        write_cloud(out, coloured_parts([one.points for one in found.segments], site.place))
    if is_shown:
        offset = near_origin(points.points)
        cloud = Cloud("map", points.points - offset)
        show(recording_of(path, out), {"cloud": cloud, "segments": shifted(found, offset)})
    return {**_answer(found), "crs": site.place.crs}


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
