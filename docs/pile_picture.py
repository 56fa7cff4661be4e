"""Draw what each segmentation plugin finds in one cloud, seen from above and obliquely.

python docs/pile_picture.py pile.ply
"""

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from executive.clouds.reader import read_site
from executive.commands.chosen import chosen
from executive.interfaces.segmentation import Segmenter
from executive.messages.cloud import Cloud
from executive.tree.choices import Choices

IMAGES = Path(__file__).parent / "images"
_ROOM_M = 0.4  # about what rises
PLUGINS = ("ground_and_clusters", "ground_and_parts")
UP = np.array([[1, 0, 0], [0, 0.5, 0.87]])  # seen from the south, 60 degrees above the horizon


def main(path: Path) -> Path:
    """Segment the cloud with each plugin, and draw a colour a segment."""
    cloud = Cloud("map", read_site(path))
    picture, axes = plt.subplots(1, len(PLUGINS), figsize=(13, 4.6), layout="constrained")
    for axis, name in zip(axes, PLUGINS, strict=True):
        choices = Choices(("segmentation",), [f"segmentation.plugin={name}"])
        with chosen(Segmenter, choices) as segmenter:
            found = segmenter.segment(cloud)
        rising = [one.points for one in found.segments]
        axis.plot(*(found.ground.points @ UP.T).T, ",", color="#b5b5b5", rasterized=True)
        for number, points in enumerate(rising):
            axis.plot(*(points @ UP.T).T, ".", ms=1.5, color=plt.get_cmap("tab20")(number % 20))
        shown = np.vstack(rising or [cloud.points]) @ UP.T
        low, high = shown.min(axis=0) - _ROOM_M, shown.max(axis=0) + _ROOM_M
        axis.set(title=f"{name}: {len(rising)} segments", xlabel="x [m]", aspect="equal")
        axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    answer = IMAGES / "perception_pile.png"
    picture.savefig(answer, dpi=75)
    return answer


if __name__ == "__main__":
    print(main(Path(sys.argv[1])))
