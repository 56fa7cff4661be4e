"""Make the pictures of the page on surveying: a photograph and the cloud made of such photographs.

executive run map_site --set surveying.plugin=simulated_photographs \\
    --set surveying.folder=photographs
executive survey photographs --out survey.ply
python docs/survey_pictures.py photographs survey.ply
"""

import sys
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import open3d as o3d
from PIL import Image

from executive.arrays import Float
from executive.clouds.reader import read_points

IMAGES = Path(__file__).parent / "images"
_SUN = np.array([-0.45, 0.3, 0.84])


def photograph(folder: Path) -> Path:
    """Save the fifth photograph, smaller."""
    name = sorted(path for path in folder.iterdir() if path.suffix.lower() in (".jpg", ".png"))[4]
    path = IMAGES / "survey_photograph.png"
    with Image.open(name) as picture:
        picture.convert("RGB").resize((800, 600)).quantize(128).save(path, optimize=True)
    return path


def cloud(file: Path) -> Path:
    """Draw the cloud from above and from the side: brightness by slope, colour by height."""
    points = read_points(file)
    points = points - np.median(points, axis=0)
    shade = _shade(points)
    fig, axes = plt.subplots(1, 2, figsize=(12, 5), width_ratios=[1, 1.6])
    _draw(axes[0], points, points[:, 2], shade, (1, 0))
    _draw(axes[1], _turned(points), points[:, 2], shade, (0, 1))
    for axis, title in zip(axes, ("from above", "from the side, 35° up"), strict=True):
        axis.set_title(title)
        axis.set_aspect("equal")
        axis.set_axis_off()
    path = IMAGES / "survey_cloud.png"
    fig.tight_layout()
    fig.savefig(path, dpi=100, bbox_inches="tight")
    return path


def _draw(
    axis: plt.Axes, points: Float, height: Float, shade: Float, order: tuple[int, int]
) -> None:
    order_drawn = np.argsort(points[:, 2])
    colours = plt.get_cmap("viridis")(np.clip((height + 0.1) / 1.1, 0, 1))[:, :3] * shade[:, None]
    across, up = order
    axis.scatter(
        points[order_drawn, across],
        points[order_drawn, up],
        s=1.6,
        c=colours[order_drawn],
        linewidths=0,
    )


def _shade(points: Float) -> Float:
    """Return how much sun each point gets, 0.3 … 1, by the plane through its neighbours."""
    sparse = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
    sparse.estimate_normals(o3d.geometry.KDTreeSearchParamKNN(20))
    sparse.orient_normals_to_align_with_direction([0.0, 0.0, 1.0])
    return np.asarray(0.3 + 0.7 * np.clip(np.asarray(sparse.normals) @ _SUN, 0, 1))


def _turned(points: Float) -> Float:
    """Return points as seen from one side and above: right, up, towards the eye."""
    c, s = np.cos(np.radians(35)), np.sin(np.radians(35))
    x, y, z = points.T
    return np.column_stack([-y, s * x + c * z, -c * x + s * z])


if __name__ == "__main__":
    IMAGES.mkdir(exist_ok=True)
    print(photograph(Path(sys.argv[1])), cloud(Path(sys.argv[2])))
