"""`executive changes`: what came, went and moved between two clouds of one site."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from executive.commands.clouds.align import GuessOption
from executive.commands.console import answer, check_output, say
from executive.commands.options import JsonOption, SetOption, WidestOption

if TYPE_CHECKING:
    from executive.arrays import Float
    from executive.interfaces.registration import Registrar
    from executive.messages.segment import Segment

_AROUND_M = 1.0  # ground around what came, for a search among it


def changes(  # noqa: PLR0913 - the options of the command line, each a parameter to typer
    earlier: Annotated[Path, typer.Argument(metavar="EARLIER", help="Cloud of the site before.")],
    later: Annotated[Path, typer.Argument(metavar="LATER", help="Cloud of the site afterwards.")],
    guess: GuessOption = None,
    noise: Annotated[
        float,
        typer.Option(
            min=0.005, max=0.5, help="Three standard deviations of heights, misfit included [m]."
        ),
    ] = 0.06,
    widest: WidestOption = None,
    set_: SetOption = None,
    out: Annotated[
        Path | None, typer.Option(help="PLY file for what came, went and moved, one colour each.")
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Tell what came, went and moved on a site.

    The clouds are in one frame, as maps of one mission are; else --guess gives the pose of LATER
    in EARLIER, which `register LATER EARLIER --json` finds. What LATER does not show, as behind an
    occluder, is told as unseen.

    Example: executive changes monday/map.ply friday/map.ply --out changes.ply
    """
    from executive.clouds.coordinate_system import coordinate_system
    from executive.clouds.ply_writer import write_parts
    from executive.clouds.reader import read_site
    from executive.commands.clouds.guess import read_guess
    from executive.geometry.pose import transform

    check_output("--out", out, ".ply", read=(earlier, later))
    T_earlier_later, scale = read_guess(guess)
    before = read_site(earlier, widest)
    after = transform(T_earlier_later, scale * read_site(later, widest))
    found, crs = _compared(before, after, noise, set_ or ()), coordinate_system(earlier)
    _say(found)
    if out:
        groups = (found.came, found.went, [now for _, now, _ in found.moved])
        write_parts(out, [_joined(group) for group in groups if group], crs)
    if as_json:
        answer({**_answer(found), "crs": crs})


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """What differs between two clouds; `moved` holds T_now_before of each pair, shape (4, 4)."""

    came: "Sequence[Segment]"
    went: "Sequence[Segment]"
    moved: "Sequence[tuple[Segment, Segment, Float]]"
    unseen: "Sequence[Segment]"
    stayed: int


def _compared(before: "Float", after: "Float", noise_m: float, set_: "Sequence[str]") -> _Found:
    """Segment both clouds, which are in one frame, and compare what stands where."""
    from executive.clouds.changes import HeightMap, Standing, check_overlap, verdicts
    from executive.commands.chosen import chosen
    from executive.interfaces.registration import Registrar
    from executive.interfaces.segmentation import Segmenter
    from executive.messages.cloud import Cloud
    from executive.tree.choices import Choices

    check_overlap(before, after)
    with chosen(Segmenter, Choices(("segmentation",), set_)) as segmenter:
        were, are = (segmenter.segment(Cloud("map", one)).segments for one in (before, after))

    def those(things: "Sequence[Segment]", other: "Float") -> "dict[Standing, list[Segment]]":
        by: dict[Standing, list[Segment]] = {standing: [] for standing in Standing}
        found = verdicts([one.points for one in things], HeightMap(other), noise_m)
        for one, verdict in zip(things, found, strict=True):
            by[verdict.standing].append(one)
        return by

    old, new = those(were, after), those(are, before)
    went, came = old[Standing.ABSENT], new[Standing.ABSENT]
    moved: list[tuple[Segment, Segment, Float]] = []
    if went and came:
        with chosen(Registrar, Choices(("registration",))) as registrar:
            moved = _moved(registrar, went, came, after)
    return _Found(
        [one for one in came if all(one is not now for _, now, _ in moved)],
        [one for one in went if all(one is not then for then, _, _ in moved)],
        moved,
        old[Standing.UNSEEN],
        len(old[Standing.STAYED]),
    )


def _say(found: _Found) -> None:
    from executive.geometry.pose import transform

    for word, things in (("came", found.came), ("went", found.went), ("unseen", found.unseen)):
        for one in things:
            say(f"  {word:7} {_line(one)}")
    for old, _, T in found.moved:
        say(f"  moved   {_line(old)}, to {_words(transform(T, old.centroid))} m")
    say(
        f"{len(found.came)} came, {len(found.went)} went, {len(found.moved)} moved, "
        f"{found.stayed} stayed, {len(found.unseen)} unseen"
    )


def _answer(found: _Found) -> dict[str, Any]:
    return {
        "came": [_told(one) for one in found.came],
        "went": [_told(one) for one in found.went],
        "moved": [
            {"before": _told(old), "after": _told(now), "T": T.tolist()}
            for old, now, T in found.moved
        ],
        "stayed": found.stayed,
        "unseen": [_told(one) for one in found.unseen],
    }


def _moved(
    registrar: "Registrar", went: "Sequence[Segment]", came: "Sequence[Segment]", after: "Float"
) -> "list[tuple[Segment, Segment, Float]]":
    """Find what went among what came: each pair, and T_now_before (4, 4)."""
    import numpy as np

    from executive.geometry.pose import transform
    from executive.messages.cloud import Cloud

    left = list(came)
    pairs: list[tuple[Segment, Segment, Float]] = []
    for old in went:
        for now in left:
            low, high = now.points.min(axis=0) - _AROUND_M, now.points.max(axis=0) + _AROUND_M
            about = after[((after >= low) & (after <= high)).all(axis=1)]
            found = registrar.find(Cloud("map", about), Cloud("model", old.points))
            place = transform(found.T_target_source, old.centroid)
            near_m = 0.5 * float(now.extents[0])
            if found.accepted and np.linalg.norm(place - now.centroid) < near_m:
                pairs.append((old, now, found.T_target_source))
                left.remove(now)
                break
    return pairs


def _joined(things: "Sequence[Segment]") -> "Float":
    import numpy as np

    return np.vstack([one.points for one in things])


def _words(values: "Float") -> str:
    return " ".join(f"{x:.2f}" for x in values)


def _line(one: "Segment") -> str:
    return f"{len(one.points)} points at {_words(one.centroid)} m, {_words(one.extents)} m long"


def _told(one: "Segment") -> dict[str, Any]:
    return {
        "points": len(one.points),
        "centroid": one.centroid.tolist(),
        "extents": one.extents.tolist(),
    }
