"""Registration beside PCL's own parts, on the same segments: time and rate of both.

Seeds 2400 and up are drawn here only.
"""

import json
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from bounds import Bound, Figure, held, judged
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings
from perception.piles import load_scenes
from perception.trials import registrar

from executive.arrays import Float
from executive.geometry.pose import transform
from executive.geometry.rotation import angle_between
from executive.messages.cloud import Cloud
from executive.messages.segment import Segmentation

SOURCE = Path(__file__).parents[1] / "perception" / "pcl" / "chain.cpp"
INCLUDES = ("/usr/include/pcl-1.13", "/usr/include/pcl-1.14", "/usr/include/eigen3")
LIBRARIES = (
    "features",
    "keypoints",
    "recognition",
    "registration",
    "search",
    "kdtree",
    "filters",
    "common",
)
RADII = {"PCL, the paper's radii": (0.06, 0.10), "PCL, segment_shot's radii": (0.12, 0.40)}
RAYS, FIRST_SEED, OURS = 190_000, 2400, "segment_shot"


@dataclass
class Tally:
    """What came of one way to register."""

    right: int = 0
    times_ms: list[float] = field(default_factory=list)


def is_installed() -> bool:
    """Return whether a compiler and PCL's headers are there."""
    return shutil.which("g++") is not None and any(
        Path(folder, "pcl").is_dir() for folder in INCLUDES
    )


def compiled(folder: Path) -> Path:
    """Compile PCL's chain into a folder and return the program."""
    program = folder / "chain"
    includes = [f"-I{folder}" for folder in INCLUDES]
    libraries = [*(f"-lpcl_{name}" for name in LIBRARIES), "-llz4"]
    options = ["-O3", "-DNDEBUG", "-std=c++17"]
    subprocess.run(
        ["g++", *options, *includes, str(SOURCE), "-o", str(program), *libraries], check=True
    )
    return program


def _write(path: Path, segmentation: Segmentation) -> None:
    rows = [
        np.column_stack([one.points, np.full(len(one.points), one.id)])
        for one in segmentation.segments
    ]
    np.vstack(rows).astype(np.float32).tofile(path)


def _run(chain: Path, folder: Path, radii: tuple[float, float]) -> tuple[Float | None, float]:
    """Return T_target_source, or None, and milliseconds; PCL 1.13 is seen to crash where no
    keypoint is described.
    """
    words = [chain, folder / "target", folder / "source", *map(str, radii)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120)
    if done.returncode:
        return None, np.nan
    answer = json.loads(done.stdout)
    return (np.array(answer["T"]).reshape(4, 4) if answer["found"] else None), answer["timings_ms"][
        "total"
    ]


def tallied(chain: Path, folder: Path, count: int) -> dict[str, Tally]:
    """Register so many scenes in all ways."""
    scenes, ours = load_scenes(), registrar()
    segmentation = GroundAndClusters(GroundAndClustersSettings())
    segmentation.start()
    tallies = {OURS: Tally(), **{name: Tally() for name in RADII}}
    for seed in range(FIRST_SEED, FIRST_SEED + count):
        scene = scenes.scene_of(seed, rays=RAYS)
        thinned = Cloud("survey", scenes._thin(scene.source.points, 0.03))
        found = ours.register(scene.target, thinned, np.random.default_rng(0))
        spent = {k: v for k, v in found.timings_ms.items() if k not in ("segmentation", "total")}
        tallies[OURS].times_ms.append(sum(spent.values()))
        if found.accepted:
            tallies[OURS].right += _is_right(scene, found.apply, found.T_target_source)
        _write(folder / "target", segmentation.segment(scene.target))
        _write(folder / "source", segmentation.segment(thinned))
        for name, radii in RADII.items():
            T, spent_ms = _run(chain, folder, radii)
            tallies[name].times_ms.append(spent_ms)
            if T is not None:
                tallies[name].right += _is_right(scene, partial(transform, T), T)
    return tallies


def measured(count: int) -> list[Figure]:
    """Print the table of all ways, and hold ours against each of PCL's."""
    with tempfile.TemporaryDirectory() as scratch:
        tallies = tallied(compiled(Path(scratch)), Path(scratch), count)
    print(f"\n  {'segmentation apart':28}{'right':>10}{'median':>10}{'p95':>10}   [ms]")
    for name, tally in tallies.items():
        middle, late = np.nanmedian(tally.times_ms), np.nanpercentile(tally.times_ms, 95)
        print(f"  {name:28}{tally.right:>4} of {count:<3}{middle:10.0f}{late:10.0f}")
    ours = tallies[OURS]
    found = []
    for name in RADII:
        other = tallies[name]
        most = Bound(other.right, is_least=True)
        found.append(held(f"right, beside {name}, of {count}", ours.right, most))
        other_ms, own_ms = np.nanmedian(other.times_ms), float(np.median(ours.times_ms))
        found.append(
            judged(
                f"median time, beside {name} [ms]",
                f"{own_ms:.0f}",
                f"< {other_ms:.0f}",
                own_ms < other_ms,
            )
        )
    return found


def _is_right(scene: Any, apply: Callable[[Float], Float], T: Float) -> bool:
    turn_rad = angle_between(T[:3, :3], scene.T_target_source[:3, :3])
    return bool(scene.errors(apply)[1] < 0.05 and turn_rad < np.radians(1))
