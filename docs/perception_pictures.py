"""Draw the segments of two clouds, and those of both after registration, seen from above.

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


def main(source: Path, target: Path) -> Path:
    """Register a source over a target and draw the segments of each and of both."""
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
    path = IMAGES / "perception_segments.png"
    segments.savefig(path, dpi=75)
    return path


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
    print(main(Path(sys.argv[1]), Path(sys.argv[2])))
