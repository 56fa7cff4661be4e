"""The commands on clouds; whatever is heavy is imported inside the command that needs it."""

import json
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

JsonOption = Annotated[bool, typer.Option("--json", help="Answer on standard output, for machines.")]


def segment(
    cloud: Annotated[Path, typer.Argument(metavar="CLOUD", help="PLY, PCD or XYZ file, in metres, z roughly up.")],
    method: Annotated[str | None, typer.Option(help="Name of a segmentation plugin.")] = None,
    out: Annotated[Path | None, typer.Option(help="PLY file to write the segments to, one colour each.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Find the objects on the ground of a cloud."""
    from executive.clouds.coloured_ply import write_parts
    from executive.clouds.reader import read_site
    from executive.messages.cloud import Cloud
    from executive.perception.plugin_choice import chosen

    _check_out(out)
    points = read_site(cloud)
    with chosen("segmentation", method) as plugin:
        found = plugin.segment(Cloud(cloud.stem, points))
    for one in found.segments:
        centre, size = (" ".join(f"{x:.2f}" for x in values) for values in (one.centroid, one.extents))
        _say(f"  {one.id:3}  {len(one.points):7} points at {centre} m, {size} m long")
    _say(f"{cloud}: {len(found.segments)} segments of {len(points)} points")
    if out:
        write_parts(out, [one.points for one in found.segments])
    if as_json:
        segments = [
            {"id": s.id, "points": len(s.points), "centroid": s.centroid.tolist(), "extents": s.extents.tolist()}
            for s in found.segments
        ]
        print(json.dumps({"segments": segments, "ground_plane": found.ground_plane.tolist()}, indent=2))


def register(
    source: Annotated[Path, typer.Argument(metavar="SOURCE", help="The cloud to be moved: PLY, PCD or XYZ.")],
    target: Annotated[Path, typer.Argument(metavar="TARGET", help="The cloud to lay it over.")],
    method: Annotated[str | None, typer.Option(help="Name of a registration plugin.")] = None,
    out: Annotated[Path | None, typer.Option(help="PLY file for both, one colour each; written if accepted.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Lay one cloud over another without a guess; status 1 if no motion is to be believed."""
    import numpy as np

    from executive.clouds.coloured_ply import write_parts
    from executive.clouds.reader import read_site
    from executive.messages.cloud import Cloud
    from executive.perception.plugin_choice import chosen

    _check_out(out)
    clouds = Cloud("target", read_site(target)), Cloud("source", read_site(source))
    with chosen("registration", method) as plugin:
        found = plugin.register(*clouds, np.random.default_rng(0))
    _say(f"{'accepted' if found.accepted else 'refused'}: {found.reason}")
    if out and found.accepted:
        write_parts(out, [clouds[0].points, found.apply(clouds[1].points)])
    if as_json:
        print(json.dumps(_answer(found), indent=2))
    raise typer.Exit(0 if found.accepted else 1)


def _answer(found: Any) -> dict[str, Any]:
    """Return an `Alignment` as plain values, SI units in the names."""
    return {
        "T": found.T_target_source.tolist(),
        "accepted": found.accepted,
        "reason": found.reason,
        "rmse_m": found.rmse_m,
        "overlap": found.overlap,
        "matched_segments": [list(pair) for pair in found.matched_segments],
        "scale": found.scale,
        "timings_ms": dict(found.timings_ms),
    }


def _check_out(path: Path | None) -> None:
    from executive.errors import ConfigError

    if path and (path.suffix.lower() != ".ply" or not path.parent.is_dir()):
        raise ConfigError(f"--out: {path}: name a .ply file in a folder that exists")


def _say(text: str) -> None:
    print(text, file=sys.stderr)
