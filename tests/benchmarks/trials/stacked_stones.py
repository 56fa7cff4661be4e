"""What `stacked_stones.py` measures."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.alignment.gicp import Gicp
from executive_plugins.alignment.settings import GicpSettings
from executive_plugins.grasping.learning.training_scene import convex_solid
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.sqlite import SqliteObjects
from executive_plugins.physics.quarried_block import block

from executive.arrays import Float
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import about_axis, exp_so3
from executive.geometry.voxels import voxel_means
from executive.interfaces.alignment import Aligner
from executive.leaf.fitting import FittingSettings
from executive.leaf.form_evidence import form_refusal
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment

VOLUME_M3 = (0.4, 0.9)
GAP_M = 0.1  # between the two stones below
NOISE_M, CELL_M = 0.012, 0.03  # of the ranges; of the map
OFF_M, OFF_RAD = 0.05, 0.05  # of the expected pose along and about each axis
FITTING = FittingSettings()
REACH_M, MARGIN_M = FITTING.max_distance, FITTING.margin
HEADINGS = 8
ROLLS, ROLL_RAD = 3, (0.44, 2.1)  # of a stone that has turned over beside its place, 25° to 120°
RIGHT_M = 0.10  # of any point of the model
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True)
class Trial:
    """One scene, without and with the points of the stones below: first, second of each pair.

    Attributes:
        seen: Whether the right stone was accepted, and each point of it within 10 cm.
        wrong: How many wrong fits were accepted: of another stone, or of the right one elsewhere.
        partly: The same of a stone that was put there and is known from two sides only, by the
            whole form and by its known surface: whether it was seen.
        rolled: How many wrong fits of it were accepted where it had rolled over, out of `ROLLS`,
            by either.
    """

    seen: tuple[bool, bool]
    wrong: tuple[int, int]
    partly: tuple[bool, bool]
    rolled: tuple[int, int]


def trial(seed: int) -> Trial:
    """Try the right stone and a wrong one."""
    rng = np.random.default_rng(seed)
    volume = rng.uniform(*VOLUME_M3)
    shapes = [block(volume if k > 1 else rng.uniform(*VOLUME_M3), rng) for k in range(4)]
    below, top, other = _stacked(shapes[:2], rng), shapes[2], shapes[3]
    z = max(one[:, 2].max() for one in below) - top[:, 2].min() - 0.05
    top = top + [*rng.normal(0, 0.05, 2), z]
    scene = voxel_means(_view([*below, top], rng, _lidars(rng)), CELL_M)
    models = [_model(one, rng) for one in (*below, top)]
    centre = models[2].mean(axis=0)
    off = pose(exp_so3(rng.normal(0, OFF_RAD, 3)), rng.normal(0, OFF_M, 3))
    expected = transform(off, models[2] - centre) + centre
    stranger = _model(other + [0, 0, 2.0], rng)
    stranger = stranger - stranger.mean(axis=0) + centre
    seen, wrong = [], []
    for leave_out in (True, False):
        T = _fitted(scene, [*models[:2], expected], leave_out)
        error_m = np.inf
        if T is not None:
            error_m = float(np.linalg.norm(transform(T, expected) - models[2], axis=1).max())
        seen.append(error_m < RIGHT_M)
        wrong.append(
            int(RIGHT_M <= error_m < np.inf) + _strangers(scene, models[:2], stranger, leave_out)
        )
    partly, rolled = _known_partly(below, top, models[:2], rng)
    return Trial((seen[0], seen[1]), (wrong[0], wrong[1]), partly, rolled)


def _known_partly(
    below: Sequence[Float], top: Float, models: Sequence[Float], rng: np.random.Generator
) -> tuple[tuple[bool, bool], tuple[int, int]]:
    """Try a stone known from two sides, where it was put, and where it has rolled over there."""
    middle, lidars = top.mean(axis=0), _lidars(rng)
    known = voxel_means(_view([top], rng, _around(middle)[:2]), CELL_M)
    centre = known.mean(axis=0)
    off = pose(exp_so3(rng.normal(0, OFF_RAD, 3)), rng.normal(0, OFF_M, 3))
    expected = transform(off, known - centre) + centre

    def right(shape: Float, truth: Float) -> list[bool | None]:
        """Return whether the fits are right, by the whole form and by the known surface."""
        scene = voxel_means(_view([*below, shape], rng, lidars), CELL_M)
        errors = []
        for is_expected in (False, True):
            T = _fitted(scene, [*models, expected], True, is_expected)
            errors.append(None if T is None else np.abs(transform(T, expected) - truth).max())
        return [None if one is None else bool(one < RIGHT_M) for one in errors]

    here, wrong = right(top, known), np.zeros(2, dtype=int)
    for _ in range(ROLLS):
        axis = about_axis(UP, rng.uniform(0, 2 * np.pi))[0]
        R = exp_so3(rng.uniform(*ROLL_RAD) * axis)
        shape = (top - middle) @ R.T + middle + [*rng.normal(0, 0.1, 2), 0]
        lowered = np.array([0, 0, top[:, 2].min() - shape[:, 2].min()])
        truth = (known - middle) @ R.T + (shape + lowered).mean(axis=0)
        wrong += [one is False for one in right(shape + lowered, truth)]
    return (bool(here[0]), bool(here[1])), (int(wrong[0]), int(wrong[1]))


def _strangers(scene: Float, below: Sequence[Float], stranger: Float, leave_out: bool) -> int:
    """Return under how many headings another stone is accepted in place of the right one."""
    centre, accepted = stranger.mean(axis=0), 0
    for k in range(HEADINGS):
        R = about_axis(UP, 2 * np.pi * k / HEADINGS)
        turned = (stranger - centre) @ R.T + centre
        accepted += _fitted(scene, [*below, turned], leave_out) is not None
    return accepted


def _fitted(
    scene: Float, models: Sequence[Float], leave_out: bool, is_expected: bool = False
) -> Float | None:
    """Return the fit of the last model as the leaves make it, or without their two steps against
    the stones below; None if it is refused.
    """
    objects = SqliteObjects(SqliteObjectsSettings())
    objects.open(":memory:")
    segments = [
        Segment(k, one, one.mean(axis=0), np.ptp(one, axis=0)) for k, one in enumerate(models)
    ]
    stones = objects.observe(segments, 0.0, True)
    own, cloud = stones[-1], Cloud("map", scene)
    source = own.points_map
    if leave_out:
        cloud = objects.unexplained(cloud, own.id, 5.0)
    objects.close()
    low, high = source.min(axis=0) - MARGIN_M, source.max(axis=0) + MARGIN_M
    aligner: Aligner = Gicp(GicpSettings())
    around = cloud.in_box(low, high)
    found = aligner.align(around, Cloud("map", source), np.eye(4), REACH_M)
    if not found.accepted:
        return None
    refusal = form_refusal(around, found.apply(source), FITTING, is_expected)
    return None if refusal and leave_out else found.T_target_source


def _stacked(shapes: Sequence[Float], rng: np.random.Generator) -> list[Float]:
    """Return two blocks side by side on the ground z = 0."""
    placed = []
    for side, shape in zip((-1, 1), shapes, strict=True):
        turned = shape @ about_axis(UP, rng.normal(0, 0.2)).T
        y = side * (0.5 * GAP_M + 0.5 * np.ptp(turned[:, 1]))
        placed.append(turned - [0, 0, turned[:, 2].min()] + [0, y, 0])
    return placed


def _model(shape: Float, rng: np.random.Generator) -> Float:
    """Return the cloud of a block that was seen alone from all sides and from above, (N, 3)."""
    return voxel_means(_view([shape], rng, _around(shape.mean(axis=0))), CELL_M)


def _view(shapes: Sequence[Float], rng: np.random.Generator, sensors: Sequence[Float]) -> Float:
    """Return what sensors see of blocks without the ground, which segmentation leaves out."""
    solids = [convex_solid(shape) for shape in shapes]
    corners = np.vstack(shapes)
    low, high = corners.min(axis=0), corners.max(axis=0)
    parts = []
    for sensor in sensors:
        toward = rng.uniform(low, high, (5000, 3)) - sensor
        directions = toward / np.linalg.norm(toward, axis=1, keepdims=True)
        ranges = np.min([solid(sensor, directions) for solid in solids], axis=0)
        hit = np.isfinite(ranges)
        noisy = ranges[hit] + rng.normal(0, NOISE_M, int(hit.sum()))
        parts.append(sensor + directions[hit] * noisy[:, None])
    return np.vstack(parts)


def _lidars(rng: np.random.Generator) -> list[Float]:
    """Return the places of two lidars on a cabin that swings, 5 m away and 3.2 m high."""
    heading = rng.uniform(0, 2 * np.pi)
    return [
        np.array([5 * np.cos(heading + a), 5 * np.sin(heading + a), 3.2]) for a in (-0.3, 0, 0.3)
    ]


def _around(centre: Float) -> list[Float]:
    """Return the places of a drone that flies around a stone, 3 m away and 3 m above it."""
    angles = 2 * np.pi * np.arange(6) / 6
    return [centre + [3 * np.cos(a), 3 * np.sin(a), 3] for a in angles]


def figures(trials: Sequence[Trial]) -> list[Figure]:
    """Return recognitions and false ones, with and without the points of the stones below."""
    n = len(trials)
    seen, before = (sum(one.seen[k] for one in trials) for k in (0, 1))
    wrong, wrong_before = (sum(one.wrong[k] for one in trials) for k in (0, 1))
    fits = n * (HEADINGS + 1)
    partly, partly_whole = (sum(one.partly[k] for one in trials) for k in (1, 0))
    rolled, rolled_whole = (sum(one.rolled[k] for one in trials) for k in (1, 0))
    return [
        held("right stones seen", seen / n, Bound(0.95, is_least=True), f"{seen} of {n}"),
        held("false recognitions", wrong, Bound(0), f"{wrong} of {fits}"),
        held(
            "stones known from two sides seen",
            partly / n,
            Bound(0.75, is_least=True),
            f"{partly} of {n}",
        ),
        held("of them, rolled over, taken to stand", rolled, Bound(0), f"{rolled} of {ROLLS * n}"),
        Figure("stones known from two sides seen, by the whole form", f"{partly_whole} of {n}"),
        Figure("of them, rolled over, by the whole form", f"{rolled_whole} of {ROLLS * n}"),
        Figure("right stones seen, without these two steps", f"{before} of {n}"),
        Figure("false recognitions, without these two steps", f"{wrong_before} of {fits}"),
    ]
