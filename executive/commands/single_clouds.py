"""The commands on clouds; whatever is heavy is imported inside the command that needs it."""

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

JsonOption = Annotated[
    bool, typer.Option("--json", help="Answer on standard output, for machines.")
]


def segment(
    cloud: Annotated[
        Path,
        typer.Argument(
            metavar="CLOUD", help="PLY, PCD, LAS, LAZ or XYZ file, in metres, z roughly up."
        ),
    ],
    method: Annotated[str | None, typer.Option(help="Name of a segmentation plugin.")] = None,
    out: Annotated[
        Path | None, typer.Option(help="PLY file to write the segments to, one colour each.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Find the objects on the ground of a cloud."""
    from executive.clouds.ply_writer import write_parts
    from executive.clouds.reader import read_site
    from executive.commands.alignment_answer import check_out
    from executive.commands.plugin_choice import chosen
    from executive.messages.cloud import Cloud

    check_out(out)
    points = read_site(cloud)
    with chosen("segmentation", method) as plugin:
        found = plugin.segment(Cloud(cloud.stem, points))
    for one in found.segments:
        centre, size = (
            " ".join(f"{x:.2f}" for x in values) for values in (one.centroid, one.extents)
        )
        _say(f"  {one.id:3}  {len(one.points):7} points at {centre} m, {size} m long")
    _say(f"{cloud}: {len(found.segments)} segments of {len(points)} points")
    if out:
        write_parts(out, [one.points for one in found.segments])
    if as_json:
        segments = [
            {
                "id": s.id,
                "points": len(s.points),
                "centroid": s.centroid.tolist(),
                "extents": s.extents.tolist(),
            }
            for s in found.segments
        ]
        print(
            json.dumps(
                {"segments": segments, "ground_plane": found.ground_plane.tolist()}, indent=2
            )
        )


def register(
    source: Annotated[
        Path,
        typer.Argument(metavar="SOURCE", help="The cloud to be moved: PLY, PCD, LAS, LAZ or XYZ."),
    ],
    target: Annotated[Path, typer.Argument(metavar="TARGET", help="The cloud to lay it over.")],
    method: Annotated[str | None, typer.Option(help="Name of a registration plugin.")] = None,
    out: Annotated[
        Path | None, typer.Option(help="PLY file for both, one colour each; written if accepted.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Lay one cloud over another without a guess; status 1 if no motion is to be believed."""
    import numpy as np

    from executive.clouds.reader import read_site
    from executive.commands.alignment_answer import alignment_answer, check_out, verdict, write_both
    from executive.commands.plugin_choice import chosen
    from executive.messages.cloud import Cloud

    check_out(out)
    clouds = Cloud("target", read_site(target)), Cloud("source", read_site(source))
    with chosen("registration", method) as plugin:
        found = plugin.register(*clouds, np.random.default_rng(0))
    _say(verdict(found, clouds[1].points, clouds[0].points))
    write_both(out, found, clouds[1].points, clouds[0].points)
    if as_json:
        print(json.dumps(alignment_answer(found), indent=2))
    raise typer.Exit(0 if found.accepted else 1)


def _say(text: str) -> None:
    print(text, file=sys.stderr)
