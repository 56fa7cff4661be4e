"""Make the pictures of docs/perception.md: two clouds before and after registration, and their
segments.

python docs/perception_pictures.py drone.ply lidar.ply
"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from executive.arrays import Float
from executive.clouds.reader import read_site
from executive.commands.chosen import chosen
from executive.interfaces.registration import Registrar
from executive.interfaces.segmentation import Segmenter
from executive.messages.cloud import Cloud

IMAGES = Path(__file__).parent / "images"
LIDAR, DRONE, GREY = "#2a9d5c", "#d1495b", "#b5b5b5"


def main(source: Path, target: Path) -> list[Path]:
    """Register a source over a target and draw both, seen from above."""
    clouds = Cloud("target", read_site(target)), Cloud("source", read_site(source))
    with chosen(Registrar) as registrar:
        found = registrar.register(*clouds, np.random.default_rng(0))
    if not found.accepted:
        sys.exit(f"refused: {found.reason}")
    moved = found.apply(clouds[1].points)
    with chosen(Segmenter) as segmenter:
        apart = [segmenter.segment(cloud) for cloud in clouds]
        merged = segmenter.segment(Cloud("target", np.vstack([clouds[0].points, moved])))
    middle = moved.mean(axis=0)
    maps, axes = plt.subplots(1, 2, figsize=(13, 6.2), layout="constrained")
    _map(
        axes[0],
        [(clouds[1].points, DRONE), (clouds[0].points, LIDAR)],
        "before: each in a frame of its own",
        None,
    )
    _map(
        axes[1],
        [(moved, DRONE), (clouds[0].points, LIDAR)],
        "after: drone red, lidar green",
        middle,
    )
    segments, axes = plt.subplots(1, 3, figsize=(17, 6.0), layout="constrained")
    parts = (apart[1], apart[0], merged)
    names = ("drone", "lidar", "both, registered")
    for axis, segmentation, name in zip(axes, parts, names, strict=True):
        centre = middle if name != "drone" else clouds[1].points.mean(axis=0)
        _map(
            axis,
            [(segmentation.ground.points, GREY)],
            f"{name}: {len(segmentation.segments)} segments",
            centre,
        )
        for number, segment in enumerate(segmentation.segments):
            _dots(axis, segment.points, f"C{number % 10}")
    paths = [IMAGES / "perception_maps.png", IMAGES / "perception_segments.png"]
    for figure, path in zip((maps, segments), paths, strict=True):
        figure.savefig(path, dpi=75)
    return paths


def _map(axis: Axes, layers: list[tuple[Float, str]], title: str, centre: Float | None) -> None:
    for points, colour in layers:
        _dots(axis, points, colour)
    axis.set(title=title, xlabel="x [m]", ylabel="y [m]", aspect="equal")
    if centre is not None:
        axis.set(xlim=(centre[0] - 6.5, centre[0] + 6.5), ylim=(centre[1] - 6.5, centre[1] + 6.5))


def _dots(axis: Axes, points: Float, colour: str) -> None:
    some = points[:: max(len(points) // 60_000, 1)]
    axis.plot(some[:, 0], some[:, 1], ",", color=colour, rasterized=True)


if __name__ == "__main__":
    IMAGES.mkdir(exist_ok=True)
    print(*main(Path(sys.argv[1]), Path(sys.argv[2])), sep="\n")
