"""A process that has imported the libraries, and starts each run of pytest as a fork of itself.

It knows nothing of the project: each run imports the product anew, and leaves nothing behind.
"""

import importlib
import os
import sys
from pathlib import Path

from mutants.forks import asked_of_a_fork

# Imported by the product or its tests, of which a tree's pyproject.toml tells which it needs.
LIBRARIES = (
    "pydantic",
    "yaml",
    "rich.console",
    "rich.live",
    "rich.table",
    "typer.testing",
    "typer.completion",
    "numpy.testing",
    "scipy.cluster.hierarchy",
    "scipy.interpolate",
    "scipy.linalg",
    "scipy.ndimage",
    "scipy.optimize",
    "scipy.sparse.linalg",
    "scipy.spatial.transform",
    "scipy.stats",
    "numba",
    "mujoco",
    "py_trees",
    "gtsam",
    "small_gicp",
    "laspy",
    "mcap.reader",
    "mcap.writer",
    "rosbags.highlevel",
    "rosbags.typesys",
    "matplotlib.figure",
    "matplotlib.collections",
    "PIL.Image",
    "ruckig",
    "psutil",
    "fcl",
)


def main() -> None:
    """Import the libraries that the tree in this folder needs, and serve."""
    project = Path("pyproject.toml")
    needed = project.read_text(encoding="utf-8").lower() if project.is_file() else ""
    importlib.import_module("pytest")
    for name in LIBRARIES:
        if name.partition(".")[0].replace("_", "-").lower() in needed:
            importlib.import_module(name)
    assert not any(name.partition(".")[0].startswith("executive") for name in sys.modules)
    here = str(Path(__file__).parent)
    sys.path[:] = [path for path in sys.path if path != here]  # as `python -m pytest` has it
    wanted = asked_of_a_fork()
    if wanted is not None:
        written = os.open(wanted["output"], os.O_WRONLY | os.O_APPEND)
        for stream in (1, 2):
            os.dup2(written, stream)
        os.environ.update(wanted["variables"])
        sys.argv = ["pytest", *wanted["words"]]
        sys.exit(importlib.import_module("pytest").main(wanted["words"]))


if __name__ == "__main__":
    main()
