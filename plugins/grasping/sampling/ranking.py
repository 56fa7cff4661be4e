"""The costs of a grasp, and the order that follows from them (Mascaro 2020, Sec. 5.4)."""

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np
from executive_plugins.grasping.sampling.closing import Holds
from executive_plugins.grasping.sampling.jaw_field import JawField

from executive.arrays import Float, Int

Costs = Mapping[str, Float]


def paper_costs(R: Float, position: Float, centre: Float, ground_normal: Float) -> dict[str, Float]:
    """Return the three costs of the paper for M grasps, each of shape (M,).

    Args:
        R: Orientations of the gripper; the first column is the approach, pointing away from the
            palm, shape (M, 3, 3).
        position: The palm's centre [m], shape (M, 3).
        centre: The stone's centre of mass: of its hull, as the mean of the visible points is drawn
            to the sensor [m].
        ground_normal: Unit normal of the ground, upward, shape (3,).

    Returns:
        `align_rad` (Eq. 5), `enclose_m` (Eq. 6), `distance_m` (Eq. 7).
    """
    approach, arm = R[:, :, 0], centre - position
    return {
        "align_rad": np.arccos(np.clip(-(approach @ ground_normal), -1.0, 1.0)),
        "enclose_m": np.einsum("ij,ij->i", arm, approach),
        "distance_m": np.linalg.norm(np.cross(arm, approach), axis=1),
    }


def ranked_rounds(costs: Costs, stages: Sequence[tuple[str, int]], final: str) -> Iterator[Int]:
    """Yield the grasps that pass all stages, the least final cost first; then the same of those
    that are left.

    A stage (name, keep) passes the `keep` grasps of least cost; with fewer, all. Equal costs are
    ordered by the costs of the other stages, then by index, so that the order is always the same.
    Each grasp is yielded once.
    """
    left = np.arange(len(costs[final]))
    while len(left):
        passed = best_first(costs, stages, final, left)
        yield passed
        left = np.setdiff1d(left, passed)


def best_first(costs: Costs, stages: Sequence[tuple[str, int]], final: str, left: Int) -> Int:
    """Return which of the indices `left` pass all stages, the least final cost first; see
    `ranked_rounds`.
    """
    names = [name for name, _ in stages] + [final]
    for i, (_, keep) in enumerate(stages):
        left = np.sort(_ordered(costs, names[i:], left)[:keep])
    return _ordered(costs, [final, *names[:-1]], left)


def _ordered(costs: Costs, names: Sequence[str], left: Int) -> Int:
    keys = [
        left,
        *(np.round(costs[name][left], 9) for name in reversed(names)),
    ]  # lexsort: the last is the first key
    return np.asarray(left[np.lexsort(keys)])


def spread(
    order: Iterable[int], R: Float, position: Float, shift_m: float, turn_rad: float
) -> Iterator[int]:
    """Yield the same indices, those first that differ from all before them: a retry is then another
    attempt.

    Args:
        order: Indices, best first; taken as they are asked for.
        R: Orientations (M, 3, 3).
        position: Palm centres [m], shape (M, 3).
        shift_m: Grasps this far apart differ.
        turn_rad: Grasps turned this far differ; a half turn about the approach is no turn, the jaws
            are alike.
    """
    first: list[int] = []
    again: list[int] = []
    for i in order:
        is_new = all(
            float(np.linalg.norm(position[i] - position[j])) > shift_m
            or _turn(R[i], R[j]) > turn_rad
            for j in first
        )
        (first if is_new else again).append(i)
        if is_new:
            yield i
    yield from again


def _turn(R_a: Float, R_b: Float) -> float:
    """Return the least angle between two orientations, each also turned half about its x [rad]."""
    D = R_a.T @ R_b
    flipped = D[0, 0] - D[1, 1] - D[2, 2]
    return float(np.arccos(np.clip((max(np.trace(D), flipped) - 1) / 2, -1.0, 1.0)))


def hold_costs(
    field: JawField, holds: Holds, held: Int, R: Float, centre: Float
) -> dict[str, Float]:
    """Return costs of the contact between the jaws, an addition to the paper, each of shape (M,).

    Returns:
        `drag_m`: how far the closing jaws move the stone until both touch.
        `shallow_m`: how far the closed tips stay above the stone's centre, along the approach;
            negative is deep.
        `twist_m`: distance of the two contacts along the jaws' width, a couple about the approach.
        `lever_m`: horizontal distance of the centre from the line through both contacts: the stone
            swings about it.
    """
    progress, contact = holds.progress[held], holds.contact[held]
    drag = np.abs(field.tip_b[progress[:, 0]] - field.tip_b[progress[:, 1]]) / 2
    local = np.einsum("mji,mj->mi", R, centre - holds.position[held])
    tip = field.tip_a[progress.max(axis=1)]
    world = np.einsum("mij,msj->msi", R, contact - local[:, None])[
        :, :, :2
    ]  # contacts from the centre, horizontal
    axis = world[:, 1] - world[:, 0]
    lever = np.abs(axis[:, 0] * world[:, 0, 1] - axis[:, 1] * world[:, 0, 0]) / np.linalg.norm(
        axis, axis=1
    )
    return {
        "drag_m": drag,
        "shallow_m": local[:, 0] - tip,
        "twist_m": np.abs(contact[:, 0, 2] - contact[:, 1, 2]),
        "lever_m": lever,
    }
