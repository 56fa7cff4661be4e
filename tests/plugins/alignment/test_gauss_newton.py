"""Steps of least squares: their equations against numbers, and when they end."""

import numpy as np
import pytest
from executive_plugins.alignment.gauss_newton import Rule, _normal_equations, _weigh, descend
from executive_plugins.alignment.surface import Planes, Surface

from executive.arrays import Float, read_only
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import exp_so3


def units(rng: np.random.Generator, count: int) -> Float:
    v = rng.normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1)[:, None]


def weight(n: Float, f: Float, is_generalised: bool) -> Float:
    W = np.empty((3, 3))
    _weigh(n, f, float(n @ f), is_generalised, W)
    return W


@pytest.mark.parametrize("seed", range(6))
def test_a_pair_weighs_by_the_inverse_of_both_covariances(seed: int) -> None:
    n, f = units(np.random.default_rng(seed), 2)
    plane = [np.eye(3) - 0.999 * np.outer(v, v) for v in (n, f)]
    assert weight(n, f, True) == pytest.approx(np.linalg.inv(plane[0] + plane[1]), rel=1e-6)
    assert weight(n, f, False) == pytest.approx(np.outer(n, n))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_faces_that_are_parallel_weigh_as_one_plane(side: float) -> None:
    n = np.array([0.0, 0.6, 0.8])
    assert weight(n, side * n, True) == pytest.approx(
        np.linalg.inv(2 * (np.eye(3) - 0.999 * np.outer(n, n))), rel=1e-6
    )


@pytest.mark.parametrize("is_generalised", [True, False])
def test_the_equations_are_those_of_the_sum_of_squares(is_generalised: bool) -> None:
    rng = np.random.default_rng(4)
    moved, met, about = *rng.normal(size=(2, 30, 3)), rng.normal(size=3)
    normals, faces = units(rng, 30), units(rng, 30)
    is_facing = np.abs(np.einsum("ij,ij->i", normals, faces)) > np.sqrt(0.5)
    rows = [read_only(part) for part in (moved, faces, met, normals)]
    H, g, pairs = _normal_equations(*rows, read_only(about), is_generalised)
    assert pairs == is_facing.sum() > 3

    def cost(x: Float) -> float:
        T = pose(t=about) @ pose(exp_so3(x[:3]), x[3:]) @ pose(t=-about)
        offsets = met - transform(T, moved)
        return sum(
            0.5 * offsets[k] @ weight(normals[k], faces[k], is_generalised) @ offsets[k]
            for k in np.flatnonzero(is_facing)
        )

    step = 1e-6 * np.eye(6)
    gradient = np.array([(cost(e) - cost(-e)) / 2e-6 for e in step])
    assert g == pytest.approx(-gradient, rel=1e-5, abs=1e-4)
    assert np.allclose(H, H.T, rtol=1e-12)
    assert (np.linalg.eigvalsh(H) > 0).all()


class Wavering(Surface):
    """Answers with one of two planes, 0.2 mm above and below, in turns."""

    asked = 0

    def within(self, queries: Float, reach_m: float) -> tuple[Float, np.ndarray]:
        self.asked += 1
        half = len(self.points) // 2
        return np.zeros(len(queries)), np.arange(half) + half * (self.asked % 2)


def test_steps_that_go_round_in_a_circle_end() -> None:
    floor = np.column_stack([*np.mgrid[0:6, 0:6].reshape(2, -1) * 0.1, np.zeros(36)])
    target = Wavering(np.vstack([floor + [0, 0, 2e-4], floor - [0, 0, 2e-4]]), 0.05, 9)
    up = np.tile([0.0, 0.0, 1.0], (72, 1))
    target.planes = lambda rows: Planes(up[rows], np.ones(len(rows)))
    rule = Rule(False, 0.3, 0.3, 0.5, 1e-4, 40, 6)
    descend(target, floor, Planes(up[:36], np.ones(36)), np.eye(4), rule)
    assert 3 < target.asked < 8
