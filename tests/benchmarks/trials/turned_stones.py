"""What `turned_stones.py` measures."""

from collections.abc import Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.alignment.gicp import Gicp
from executive_plugins.alignment.settings import GicpSettings
from executive_plugins.grasping.learning.training_scene import at_rest, convex_solid
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.sqlite import SqliteObjects
from executive_plugins.physics.quarried_block import block
from executive_plugins.registration.segment_shot import SegmentShot
from executive_plugins.registration.settings import SegmentShotSettings
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import about_axis, angle_between, exp_so3
from executive.geometry.voxels import voxel_means
from executive.leaf.fitting import Fitted, FittingSettings, fit
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment

VOLUME_M3 = (0.3, 0.9)
NOISE_M, CELL_M = 0.012, 0.03  # of the ranges; of the map
OFF_M, OFF_RAD = 0.05, 0.05  # of the expected pose along and about each axis
RAYS = 24_000  # of one place of a sensor: three in four at the ground around, the rest at the stone
AROUND_M = 2.5
FALSE_M, FALSE_RAD = 0.30, np.radians(20)
UP = np.array([0.0, 0.0, 1.0])
SEGMENTER = GroundAndClusters(GroundAndClustersSettings())


@dataclass(frozen=True, slots=True)
class Trial:
    """One scene.

    Attributes:
        turn_rad: How far the stone was turned.
        method: By what it was recognised; empty if it was refused.
        off_m: How far the answer is off; NaN if it was refused.
        off_rad: The same of its rotation.
    """

    turn_rad: float
    method: str
    off_m: float
    off_rad: float

    @property
    def is_false(self) -> bool:
        """Whether an answer was accepted that is not the stone's pose."""
        return bool(self.method) and (self.off_m > FALSE_M or self.off_rad > FALSE_RAD)


def trial(seed: int, turns: bool) -> Trial:
    """Look at a block, turn it, and look again."""
    rng = np.random.default_rng([seed, turns])
    hull = block(rng.uniform(*VOLUME_M3), rng)
    hull = transform(_rest(hull, rng), hull)
    model = _model(hull, rng)
    T = _turned(hull, rng) if turns else _settled(hull, rng)
    now = transform(T, hull)
    seen = voxel_means(_view(now, _lidars(now.mean(axis=0), rng), rng), CELL_M)
    middle = pose(t=model.mean(axis=0))
    off = pose(exp_so3(rng.normal(0, OFF_RAD, 3)), rng.normal(0, OFF_M, 3))
    expected = middle @ off @ inverse(middle)
    found = _looked(Cloud("map", seen), transform(expected, model))
    turn_rad = angle_between(T[:3, :3], np.eye(3))
    if found.refusal:
        return Trial(turn_rad, "", np.nan, np.nan)
    left = found.alignment.T_target_source @ expected @ inverse(T)
    centre = now.mean(axis=0)
    off_m = float(np.linalg.norm(transform(left, centre[None])[0] - centre))
    return Trial(turn_rad, found.method, off_m, angle_between(left[:3, :3], np.eye(3)))


def _looked(scene: Cloud, model: Float) -> Fitted:
    """Fit as the leaves do."""
    objects = SqliteObjects(SqliteObjectsSettings())
    objects.open(":memory:")
    (stone,) = objects.observe(
        [Segment(0, model, model.mean(axis=0), np.ptp(model, axis=0))], 0.0, True
    )
    plugins = {
        "objects": objects,
        "mapping": SimpleNamespace(cloud=lambda: scene),
        "alignment": Gicp(GicpSettings()),
        "registration": SegmentShot(SegmentShotSettings(), SEGMENTER, Gicp(GicpSettings())),
    }
    context: Any = SimpleNamespace(use=lambda one: plugins[one.capability], job=_job)
    steps = fit(context, stone, FittingSettings())
    while True:
        try:
            next(steps)
        except StopIteration as end:
            objects.close()
            return end.value


def _job(verb: Any, *args: Any) -> Any:
    """Compute at once, as a job of the runner `inline`."""
    yield
    return verb(*args)


def _rest(hull: Float, rng: np.random.Generator) -> Float:
    """Return the motion of a block to its rest on the ground, dropped until it comes to one."""
    while (T := at_rest(hull, rng)) is None:
        pass
    return T


def _settled(hull: Float, rng: np.random.Generator) -> Float:
    """Return a motion of some degrees and centimetres that leaves the block up."""
    centre = hull.mean(axis=0)
    R = exp_so3(rng.normal(0, OFF_RAD, 3))
    shift = np.append(rng.normal(0, OFF_M, 2), 0.0)
    T = pose(R, centre - R @ centre + shift)
    return pose(t=[0, 0, -transform(T, hull)[:, 2].min()]) @ T


def _turned(hull: Float, rng: np.random.Generator) -> Float:
    """Return a motion about a horizontal axis, after which the block has come to rest anew."""
    centre = hull.mean(axis=0)
    axis = about_axis(UP, rng.uniform(0, 2 * np.pi)) @ [1.0, 0.0, 0.0]
    turn = pose(exp_so3(axis * rng.uniform(0.8, np.pi))) @ pose(t=-centre)
    T = _rest(transform(turn, hull), rng) @ turn
    aside = (centre - transform(T, centre[None])[0]) * [1, 1, 0]
    return pose(t=aside + np.append(rng.normal(0, 3 * OFF_M, 2), 0.0)) @ T


def _model(hull: Float, rng: np.random.Generator) -> Float:
    """Return what lidars and a drone see of a block, without the ground, shape (N, 3)."""
    centre = hull.mean(axis=0)
    angles = 2 * np.pi * np.arange(6) / 6
    drone = [centre * [1, 1, 0] + [5 * np.cos(a), 5 * np.sin(a), 9] for a in angles]
    whole = voxel_means(_view(hull, [*_lidars(centre, rng), *drone], rng), CELL_M)
    segments = SEGMENTER.segment(Cloud("map", whole)).segments
    return max((one.points for one in segments), key=len)


def _lidars(centre: Float, rng: np.random.Generator) -> list[Float]:
    """Return the places of lidars on a cabin that swings, 5.5 m away and 2.8 m high."""
    heading = rng.uniform(0, 2 * np.pi)
    return [
        centre * [1, 1, 0] + [5.5 * np.cos(heading + a), 5.5 * np.sin(heading + a), 2.8]
        for a in (-0.3, 0, 0.3)
    ]


def _view(hull: Float, sensors: Sequence[Float], rng: np.random.Generator) -> Float:
    """Return what sensors see of a block and of the ground around it, shape (N, 3)."""
    cast, centre, parts = convex_solid(hull), hull.mean(axis=0), []
    box = np.array([AROUND_M, AROUND_M, 0.8])
    for sensor in sensors:
        wide = centre + rng.uniform(-box, box, (3 * RAYS // 4, 3))
        near = rng.uniform(hull.min(axis=0), hull.max(axis=0), (RAYS // 4, 3))
        toward = np.vstack([wide, near]) - sensor
        directions = toward / np.linalg.norm(toward, axis=1, keepdims=True)
        ranges = np.minimum(cast(sensor, directions), _ground(sensor, directions))
        hit = ranges < 25
        noisy = ranges[hit] + rng.normal(0, NOISE_M, int(hit.sum()))
        parts.append(sensor + directions[hit] * noisy[:, None])
    return np.vstack(parts)


def _ground(sensor: Float, directions: Float) -> Float:
    """Return ranges to the ground z = 0, infinite for rays that rise."""
    falls = np.minimum(directions[:, 2], -1e-9)
    return np.asarray(-sensor[2] / falls)


def figures(trials: Sequence[Trial]) -> list[Figure]:
    """Return false answers, and how many stones that stayed up were recognised."""
    up = [one for one in trials if one.turn_rad <= FALSE_RAD]
    over = [one for one in trials if one.turn_rad > FALSE_RAD]
    false = sum(one.is_false for one in trials)
    seen, again = (sum(bool(one.method) and not one.is_false for one in few) for few in (up, over))
    return [
        held("false answers", false, Bound(0), f"{false} of {len(trials)}"),
        held(
            "stones that stayed up, recognised",
            seen / len(up) if up else float("nan"),
            Bound(0.95, is_least=True),
            f"{seen} of {len(up)}",
        ),
        Figure("stones that turned, recognised with their turn", f"{again} of {len(over)}"),
    ]
