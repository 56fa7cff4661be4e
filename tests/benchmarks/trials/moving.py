"""What `moving.py` measures."""

import time
from collections.abc import Iterable

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.mapping.carving import VOXELS
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings

from executive.arrays import Float
from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud
from trials.forgetting import AFTER, drawn

PERIOD_S, BEFORE, AFTERWARDS = 0.1, 30, 30  # scan pairs without and with what moves
LEAST_RETURNS = 2  # of a voxel, as the map shows it
HALF = 0.5
MARGIN_M = 0.06


def block(away_m: float, side_rad: float, size: Float) -> Float:
    """Return the lowest and the highest corner of a block on the ground [m]."""
    middle = away_m * np.array([np.cos(side_rad), np.sin(side_rad), 0.0])
    corners = np.array([middle - size / 2, middle + size / 2])
    corners[:, 2] = 0.0, size[2]
    return corners


def share_on(points: Float, box: Float) -> float:
    """Return the share of points that are on a block."""
    inside = (points > box[0] - MARGIN_M).all(axis=1) & (points < box[1] + MARGIN_M).all(axis=1)
    return float(inside.mean())


class Scene:
    """Two blocks that stand and one that moves, seen by one swinging lidar."""

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        self._module = drawn()
        self._world = self._module.World(AFTER)
        self._world.rng, self._world.swing_rad = rng, rng.uniform(0, 1.5)
        self.standing = [
            block(3.6, 0.75, rng.uniform(0.5, 1.2, 3)),
            block(rng.uniform(4.5, 7), -0.3, rng.uniform(0.5, 1.0, 3)),
        ]
        size = np.array([*rng.uniform(0.4, 0.8, 2), rng.uniform(0.5, 1.8)])
        last = block(rng.uniform(4, 6), 0.2, size)
        speed, heading = rng.uniform(0.3, 1.5), rng.uniform(0, 2 * np.pi)
        self._step = speed * PERIOD_S * np.array([np.cos(heading), np.sin(heading), 0.0])
        self.moving = last
        self.taken_s: list[float] = []

    def seen(self) -> tuple[Cloud, object]:
        """Return the map's cloud after all scans, and the places in which something moves."""
        for k in range(BEFORE + AFTERWARDS):
            left = BEFORE + AFTERWARDS - 1 - k
            moved = [self.moving - left * self._step] if k >= BEFORE else []
            self._scan([*self.standing, *moved])
        points, counts = self._world.grid.points()
        return Cloud("map", points[counts >= LEAST_RETURNS]), self._world.carver.moving()

    def _scan(self, boxes: list[Float]) -> None:
        world = self._world
        world.swing_rad += 0.0175  # 10°/s at 10 Hz
        view = self._module.scan(boxes, 0.6 * np.sin(world.swing_rad), world.rng)
        world.grid.insert(view[1])
        begun_s = time.process_time()
        corners = world.carver.see([view])
        self.taken_s.append(time.process_time() - begun_s)
        world.grid.erase(corners, VOXELS)


def measured(seeds: Iterable[int]) -> list[Figure]:
    """Return which parts on moving and on standing blocks are told as moving."""
    segmenter = GroundAndClusters(GroundAndClustersSettings(), load_machine("m545"))
    segmenter.start()
    told, of_all, taken_s = {"moves": 0, "stands": 0}, {"moves": 0, "stands": 0}, list[float]()
    for seed in seeds:
        scene = Scene(seed)
        cloud, places = scene.seen()
        taken_s += scene.taken_s
        found = segmenter.segment(cloud)
        parts = [one.points for one in found.segments] + [one.surface for one in found.left_out]
        for points in parts:
            is_told = places.share(points) > HALF  # type: ignore[attr-defined]
            what = ""
            if share_on(points, scene.moving) > HALF:
                what = "moves"
            elif any(share_on(points, box) > HALF for box in scene.standing):
                what = "stands"
            if what:
                told[what] += is_told
                of_all[what] += 1
    counts = {name: f"{told[name]} of {of_all[name]}" for name in told}
    moves = 100 * told["moves"] / max(of_all["moves"], 1)
    milliseconds = 1e3 * float(np.percentile(taken_s, 95))
    return [
        held("parts on what moves, told as moving [%]", moves, Bound(95, is_least=True),
             counts["moves"]),
        held("parts on what stands, told as moving", told["stands"], Bound(0), counts["stands"]),
        held("carving of one scan, p95 [ms]", milliseconds, Bound(10), f"{milliseconds:.1f}"),
    ]  # fmt: skip
