"""Draw the layers, the loop and the path of the data, from the import contract and the registry.

    python docs/architecture_picture.py

The layers are those that import-linter checks (pyproject.toml), the capabilities are those of
`executive/registry.py` in the order of the data: when either changes, run this again.
"""

import tomllib
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes

from executive.registry import CAPABILITIES

ROOT = Path(__file__).parents[1]
PATH = Path(__file__).parent / "images" / "architecture.svg"
BLUE, GREEN, GREY, YELLOW = "#d6e4f0", "#dff0d8", "#eeeeee", "#fcf3cf"
LOOP = (
    "robot.read: what arrived since the last tick",
    "streams: estimator, mapper, monitors",
    "tree.tick: leaves start, poll or cancel jobs",
    "commands to the robot",
    "journal, recording",
)
BELOW = "numpy, py_trees, gtsam, open3d, torch, pinocchio, ..."
# Each capability of the main path, and the message that it hands to the next.
PATH_OF_DATA = (
    ("robot", "ImuSample, GnssFix, JointSample, LidarScan"),
    ("estimation", "BaseState"),
    ("mapping", "Cloud"),
    ("segmentation", "Segment"),
    ("registration", "Alignment"),
    ("objects", "Stone"),
    ("grasping", "Grasp"),
    ("placing", "Placement"),
    ("motion", "JointTrajectory, back to the robot"),
)
# Capabilities beside the path, and where they join it.
BESIDE = {
    "odometry": "estimation",
    "surveying": "registration",
    "alignment": "objects",
    "building": "placing",
    "driving": "mapping",
    "monitoring": "motion",
    "viewing": "robot",
}


def layers() -> list[list[str]]:
    """Return the layers of `executive`, the highest first; names in one row do not import each
    other.
    """
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    (contract,) = (c for c in contracts if c.get("containers") == ["executive"])
    return [[name.strip() for name in row.split("|")] for row in contract["layers"]]


def main() -> None:
    """Write the picture."""
    plt.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "executive", "font.size": 9})
    figure, axes = plt.subplots(1, 3, figsize=(14, 6.2), width_ratios=(5, 4.2, 4.6))
    for axis in axes:
        axis.set(xlim=(0, 1), ylim=(0, 1))
        axis.axis("off")
    _layers(axes[0])
    _loop(axes[1])
    _data(axes[2])
    figure.tight_layout()
    figure.savefig(PATH, metadata={"Date": None})
    print(PATH)


def _layers(axis: Axes) -> None:
    axis.set_title("Layers of executive/: imports point down", fontsize=11)
    rows = layers()
    height = 0.86 / len(rows)
    for number, names in enumerate(rows):
        bottom = 0.98 - (number + 1) * height
        width = 0.68 / len(names)
        for column, name in enumerate(names):
            _box(axis, (0.02 + column * width, bottom + 0.01, width - 0.01, height - 0.02), name)
    top = next(i for i, names in enumerate(rows) if "interfaces" in names)
    upper, lower = 0.98 - top * height, 0.98 - len(rows) * height
    _box(
        axis,
        (0.76, lower + 0.01, 0.22, upper - lower - 0.02),
        "plugins/\n\none folder\na capability;\nimports what\nis beside it,\nnever another\nfolder",
        GREEN,
    )
    _box(
        axis,
        (0.76, upper + 0.01, 0.22, 0.97 - upper),
        "robot_\nmodels/\ntrees/\n\ndata alone",
        YELLOW,
    )
    _box(axis, (0.02, 0.01, 0.96, 0.08), BELOW, GREY)


def _loop(axis: Axes) -> None:
    axis.set_title("The loop: one tick, 50 ms", fontsize=11)
    for number, step in enumerate(LOOP):
        y = 0.86 - number * 0.155
        _box(axis, (0.05, y, 0.82, 0.09), step, BLUE)
        if number:
            _arrow(axis, (0.46, y + 0.155), (0.46, y + 0.09))
    last = 0.86 - (len(LOOP) - 1) * 0.155 + 0.045
    axis.plot([0.87, 0.95, 0.95], [last, last, 0.905], color="black", lw=1)
    _arrow(axis, (0.95, 0.905), (0.87, 0.905))
    _box(
        axis,
        (0.05, 0.01, 0.82, 0.14),
        "jobs: long verbs of plugins run in line,\nin a thread or in a worker process;\n"
        "leaves never block the tick",
        GREY,
    )


def _data(axis: Axes) -> None:
    axis.set_title("The path of the data: capabilities and messages", fontsize=11)
    missing = {*CAPABILITIES} - {name for name, _ in PATH_OF_DATA} - {*BESIDE}
    if missing:
        raise SystemExit(f"the picture has no place for {', '.join(sorted(missing))}")
    step = 0.98 / len(PATH_OF_DATA)
    middles = {}
    for number, (name, message) in enumerate(PATH_OF_DATA):
        bottom = 0.98 - number * step - 0.055
        middles[name] = bottom + 0.0275
        _box(axis, (0.02, bottom, 0.34, 0.055), name, GREEN)
        axis.text(0.21, bottom - 0.027, message, ha="left", va="center", fontsize=8, style="italic")
        if number < len(PATH_OF_DATA) - 1:
            _arrow(axis, (0.19, bottom), (0.19, bottom - step + 0.055))
    for name, joined in BESIDE.items():
        if name in CAPABILITIES:
            _box(axis, (0.64, middles[joined] - 0.0275, 0.34, 0.055), name, GREY)
            ends = (0.64, middles[joined]), (0.36, middles[joined])
            _arrow(
                axis,
                *(
                    ends
                    if name in ("odometry", "surveying", "alignment", "building")
                    else ends[::-1]
                ),
            )


def _box(
    axis: Axes, place: tuple[float, float, float, float], text: str, colour: str = BLUE
) -> None:
    x, y, width, height = place
    axis.add_patch(plt.Rectangle((x, y), width, height, fc=colour, ec="black", lw=0.7))
    axis.text(x + width / 2, y + height / 2, text, ha="center", va="center")


def _arrow(axis: Axes, start: tuple[float, float], end: tuple[float, float]) -> None:
    axis.annotate("", xy=end, xytext=start, arrowprops={"arrowstyle": "->", "lw": 1})


if __name__ == "__main__":
    main()
