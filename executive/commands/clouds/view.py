"""`--view`: a result in a file for a viewer and, where there is a display, in a viewer."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from executive.commands.console import say
from executive.errors import ConfigError

if TYPE_CHECKING:
    from executive.arrays import Float
    from executive.messages.segment import Segmentation

_PORT = 9876  # of rerun
_DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY")
_VIEWER = ("viewing.plugin=rerun", "viewing.max_points=1500000")  # as many as are kept of a file

ViewOption = Annotated[
    bool,
    typer.Option(
        "--view",
        help="Write the result as a .rrd file beside OUT, or here, and where there is a display "
        "show it in a rerun viewer on this computer.",
    ),
]


def check_view(wanted: bool) -> None:
    """Refuse a view that cannot be had, before anything is computed.

    Raises:
        MissingExtraError: If its packages are not installed.
    """
    from executive.extras import require_extra

    if wanted:
        require_extra("--view", "viewing")


def recording_of(cloud: Path, out: Path | None) -> Path:
    """Return the file that a result goes to."""
    return out.with_suffix(".rrd") if out else Path(cloud.name).with_suffix(".rrd")


def show(
    path: Path,
    shown: Mapping[str, object],
    environment: Mapping[str, str] = os.environ,
    port: int = _PORT,
) -> None:
    """Write messages into a file, show them in a viewer if there is a display, and say where.

    The file is written in any case: a viewer may end before it has drawn what it was sent.

    Args:
        path: The file.
        shown: Messages by the name of what they show, such as a cloud or a segmentation.
        environment: Environment variables, which tell whether there is a display.
        port: Port of the viewer, at 127.0.0.1 alone.
    """
    from executive.commands.chosen import chosen
    from executive.interfaces.viewing import Viewer
    from executive.tree.choices import Choices

    with chosen(Viewer, Choices(("viewing",), _VIEWER)) as viewer:
        viewer.open(str(path))
        say(f"view: {path}; `rerun --bind 127.0.0.1 {path}` shows it")
        if any(environment.get(name) for name in _DISPLAYS):
            try:
                say(f"view: {viewer.show_live(port)}")
            except ConfigError as error:
                say(f"view: no viewer: {error}")
        else:
            say("view: there is no display, so no viewer was started")
        for name, value in shown.items():
            viewer.show(0.0, name, value)


def near_origin(points: "Float") -> "Float":
    """Return whole metres to take from points (N, 3) before they are shown, shape (3,).

    A viewer has single precision, in which national coordinates come in steps of half a metre.
    """
    import numpy as np

    middle: Float = np.round((points.min(axis=0) + points.max(axis=0)) / 2)
    if np.abs(middle).max() < 1000:  # single precision has steps of 0.06 mm there
        return np.zeros(3)
    say(f"shown about {middle[0]:.0f} {middle[1]:.0f} {middle[2]:.0f} m")
    return middle


def shifted(found: "Segmentation", offset: "Float") -> "Segmentation":
    """Return a segmentation in the map, about another origin [m], shape (3,)."""
    from dataclasses import replace

    from executive.messages.cloud import Cloud

    segments = (
        replace(one, points=one.points - offset, centroid=one.centroid - offset)
        for one in found.segments
    )
    ground = Cloud("map", found.ground.points - offset)
    return replace(found, frame="map", segments=tuple(segments), ground=ground)
