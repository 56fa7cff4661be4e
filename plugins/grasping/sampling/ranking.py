"""Costs of grasps, and the order that follows from them (Mascaro 2020, Sec. 5.4)."""

from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np
from executive_plugins.grasping.sampling.closing import Holds
from executive_plugins.grasping.sampling.jaw_field import JawField

from executive.arrays import Float, Int
from executive.geometry.rotation import angle_of_jaws

Costs = Mapping[str, Float]
# Grasps that are nearer to each other than both are one grasp to a planner that spreads its trials.
SPREAD_M, SPREAD_RAD = 0.10, np.radians(20.0)


def paper_costs(R: Float, position: Float, centre: Float, ground_normal: Float) -> dict[str, Float]:
    """Return the three costs of the paper for M grasps, each of shape (M,).

    Args:
        R: Orientations of the gripper; the first column is the approach, pointing away from the
            palm, shape (M, 3, 3).
        position: Centre of the palm [m], shape (M, 3).
        centre: Centre of mass of the stone, estimated by its hull [m]; the mean of the visible
            points is shifted towards the sensor.
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
    """Yield the grasps that pass all stages, by final cost; repeat with the remaining grasps.

    A stage (name, keep) passes the `keep` grasps of least cost, or all if there are fewer. Equal
    costs are ordered by the costs of the other stages, then by index, so the order is
    deterministic. Each grasp is yielded once.
    """
    left = np.arange(len(costs[final]))
    while len(left):
        passed = best_first(costs, stages, final, left)
        yield passed
        left = np.setdiff1d(left, passed)


def best_first(costs: Costs, stages: Sequence[tuple[str, int]], final: str, left: Int) -> Int:
    """Return which of the indices `left` pass all stages, by final cost; see `ranked_rounds`."""
    names = [name for name, _ in stages] + [final]
    for i, (_, keep) in enumerate(stages):
        left = np.sort(_ordered(costs, names[i:], left)[:keep])
    return _ordered(costs, [final, *names[:-1]], left)


def _ordered(costs: Costs, names: Sequence[str], left: Int) -> Int:
    # The last key of lexsort is the primary one.
    keys = [left, *(np.round(costs[name][left], 9) for name in reversed(names))]
    return np.asarray(left[np.lexsort(keys)])


def spread(
    order: Iterable[int], R: Float, position: Float, shift_m: float, turn_rad: float
) -> Iterator[int]:
    """Yield the same indices, first those that differ from all earlier ones, then the rest.

    A retry with the next grasp is then a different attempt.

    Args:
        order: Indices, best first, consumed lazily.
        R: Orientations, shape (M, 3, 3).
        position: Centres of the palm [m], shape (M, 3).
        shift_m: Grasps differ if they are this far apart.
        turn_rad: Grasps differ if they are turned this far. A half turn about the approach does not
            count, since the jaws are symmetric.
    """
    first: list[int] = []
    again: list[int] = []
    for i in order:
        is_new = not any(_are_alike(i, j, R, position, shift_m, turn_rad) for j in first)
        (first if is_new else again).append(i)
        if is_new:
            yield i
    yield from again


def first_alike(i: int, R: Float, position: Float, shift_m: float, turn_rad: float) -> int:
    """Return the first grasp that is alike, as `spread` has it: an earlier one, or the same."""
    return next(j for j in range(i + 1) if _are_alike(i, j, R, position, shift_m, turn_rad))


def _are_alike(i: int, j: int, R: Float, position: Float, shift_m: float, turn_rad: float) -> bool:
    is_near = float(np.linalg.norm(position[i] - position[j])) <= shift_m
    return is_near and angle_of_jaws(R[i], R[j]) <= turn_rad


def hold_costs(
    field: JawField, holds: Holds, held: Int, R: Float, centre: Float
) -> dict[str, Float]:
    """Return costs of the contact between the jaws, each of shape (M,); an addition to the paper.

    Returns:
        `drag_m`: how far the closing jaws move the stone until both touch.
        `shallow_m`: how far the closed tips stay above the stone's centre along the approach;
            negative if they are below.
        `twist_m`: distance of the two contacts along the width of the jaws: a couple about the
            approach.
        `lever_m`: horizontal distance of the centre from the line through both contacts, about
            which the stone swings.
    """
    progress, contact = holds.progress[held], holds.contact[held]
    drag = np.abs(field.tip_b[progress[:, 0]] - field.tip_b[progress[:, 1]]) / 2
    local = np.einsum("mji,mj->mi", R, centre - holds.position[held])
    tip = field.tip_a[progress.max(axis=1)]
    # Horizontal positions of both contacts, relative to the centre.
    world = np.einsum("mij,msj->msi", R, contact - local[:, None])[:, :, :2]
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
