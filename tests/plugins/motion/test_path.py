"""A Hermite path passes its nodes smoothly and overshoots none."""

import itertools

import numpy as np
from executive_plugins.motion.path import HermitePath, path_through

from executive.arrays import Float

VELOCITY = np.array([0.5, 1.0])
ACCELERATION = np.array([0.4, 0.8])


def zigzag() -> tuple[Float, HermitePath]:
    nodes = np.array([[0.0, 0.0], [0.5, 1.0], [0.5, 2.0], [1.0, 1.5], [1.2, 0.0]])
    return nodes, path_through(nodes, np.zeros(4, dtype=bool), VELOCITY, ACCELERATION)


def test_passes_every_node() -> None:
    nodes, path = zigzag()
    np.testing.assert_allclose(path.position(path.parameters), nodes, atol=1e-12)


def test_overshoots_no_node() -> None:
    nodes, path = zigzag()
    for i, (a, b) in enumerate(itertools.pairwise(nodes)):
        q = path.position(np.linspace(path.parameters[i], path.parameters[i + 1], 50))
        assert (q >= np.minimum(a, b) - 1e-12).all()
        assert (q <= np.maximum(a, b) + 1e-12).all()


def test_its_tangent_is_continuous_and_the_slope_of_its_position() -> None:
    _, path = zigzag()
    inner = path.parameters[1:-1]
    np.testing.assert_allclose(path.tangent(inner - 1e-9), path.tangent(inner + 1e-9), atol=1e-6)
    u = np.linspace(0.1, path.length - 0.1, 97)
    slope = (path.position(u + 1e-6) - path.position(u - 1e-6)) / 2e-6
    np.testing.assert_allclose(path.tangent(u), slope, atol=1e-6)


def test_a_rest_to_rest_interval_is_as_long_as_its_slowest_joint_needs() -> None:
    path = path_through(
        np.array([[0.0, 0.0], [1.0, 0.1]]), np.zeros(1, dtype=bool), VELOCITY, ACCELERATION
    )
    assert path.length == max(1.5 * 1.0 / 0.5, np.sqrt(6 * 1.0 / 0.4))


def test_nodes_that_coincide_make_a_short_path_not_a_crash() -> None:
    path = path_through(np.zeros((3, 2)), np.zeros(2, dtype=bool), VELOCITY, ACCELERATION)
    np.testing.assert_array_equal(path.position(np.array([0.0, path.length])), np.zeros((2, 2)))


def test_a_node_where_the_path_ends_later_is_passed_on_the_way() -> None:
    there_and_back = np.array([[0.0, 0.0], [0.5, 0.2], [-0.5, 0.1], [0.5, 0.2]])
    path = path_through(there_and_back, np.zeros(3, dtype=bool), VELOCITY, ACCELERATION)
    np.testing.assert_allclose(path.position(path.parameters), there_and_back, atol=1e-12)
