"""What `settled_piles.py` measures."""

import time
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.ground_and_parts import GroundAndParts
from executive_plugins.segmentation.settings import (
    GroundAndClustersSettings,
    GroundAndPartsSettings,
)
from perception.piles import load_scenes
from perception.settled import Settled, settled
from scipy.spatial import cKDTree

from executive.arrays import Float
from executive.clouds.ply_writer import write_ply
from executive.interfaces.segmentation import Segmenter
from executive.messages.cloud import Cloud

STONES = {"pile": 12, "touching": 8}
BOUND = "ground_and_clusters"  # the plugin whose figures are held against bounds
VISIBLE, COVERED = 0.4, 0.5
MUST = {"pile": Bound(80.0, 90.0, is_least=True), "touching": Bound(85.0, 92.0, is_least=True)}
WORDS = {"pile": "piles of 12, stones that are visible", "touching": "stones strewn, some touching"}


def overlaps(scene: Settled, segments: list[Float]) -> tuple[Float, int]:
    """Return each stone's best intersection over union, and how many segments have none of 0.5."""
    count, tree = len(scene.visible), cKDTree(scene.points)
    sizes = np.bincount(scene.labels, minlength=count + 1)[1:]
    table = np.zeros((len(segments) + 1, count))
    for row, segment in enumerate(segments):
        labels = scene.labels[tree.query(segment)[1]]
        common = np.bincount(labels, minlength=count + 1)[1:]
        table[row] = common / np.maximum(sizes + len(segment) - common, 1)
    return table.max(axis=0), int((table[:-1].max(axis=1) < COVERED).sum())


def measured(seeds: Iterable[int]) -> list[Figure]:
    """Segment all scenes with both plugins; the one of the shipped missions has bounds."""
    module, seeds = load_scenes(), list(seeds)
    convex, plain = (
        GroundAndParts(GroundAndPartsSettings()),
        GroundAndClusters(GroundAndClustersSettings()),
    )
    figures = []
    for kind, count in STONES.items():
        scenes = [settled(kind, count, seed, module) for seed in seeds]
        for name, plugin in (("ground_and_parts", convex), ("ground_and_clusters", plain)):
            figures += _told(name, plugin, kind, scenes)
    return figures


def written(path: Path, seed: int) -> Path:
    """Write the cloud of a seed's pile."""
    write_ply(path, settled("pile", STONES["pile"], seed, load_scenes()).points, "map")
    return path


def _told(name: str, plugin: Segmenter, kind: str, scenes: list[Settled]) -> list[Figure]:
    hit, asked, strange, total, spent_ms = 0, 0, 0, 0, []
    plugin.start()
    for scene in scenes:
        begun_s = time.process_time()
        found = plugin.segment(Cloud("map", scene.points)).segments
        spent_ms.append(1e3 * (time.process_time() - begun_s))
        best, others = overlaps(scene, [one.points for one in found])
        is_asked = scene.visible >= VISIBLE
        hit, asked = hit + int((best[is_asked] >= COVERED).sum()), asked + int(is_asked.sum())
        strange, total = strange + others, total + len(found)
    what, share = f"{name}: {WORDS[kind]} [%]", 100.0 * hit / max(asked, 1)
    told = f"{hit} of {asked}, {np.median(spent_ms):.0f} ms a cloud"
    main = held(what, share, MUST[kind], told) if name == BOUND else Figure(what, told)
    return [main, Figure(f"{name}: segments that are no stone", f"{strange} of {total}")]
