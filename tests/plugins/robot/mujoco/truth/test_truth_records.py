"""Rests and contacts become arrays and come back, with times that count from another zero."""

import numpy as np
from executive_plugins.robot.mujoco.sensors.articulated_mesh import ArticulatedMesh
from executive_plugins.robot.mujoco.truth.contact_log import Span
from executive_plugins.robot.mujoco.truth.truth_file import (
    rests_as_arrays,
    rests_from,
    spans_as_array,
    spans_from,
)

from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy


def test_rests_come_back_by_the_stone() -> None:
    one, two, three = (pose(t=np.array([x, 0.0, 0.0])) for x in (1.0, 2.0, 3.0))
    arrays = rests_as_arrays([[(0.0, one), (2.5, two)], [], [(1.0, three)]])
    assert arrays["rest_stones"].tolist() == [0, 0, 2]
    assert arrays["rest_since_s"].tolist() == [0.0, 2.5, 1.0]
    back = rests_from(arrays, 3, 0.5)
    assert [[since_s for since_s, _ in rests] for rests in back] == [[-0.5, 2.0], [], [0.5]]
    np.testing.assert_array_equal([T for _, T in back[0]], [one, two])
    np.testing.assert_array_equal(back[2][0][1], three)
    assert rests_as_arrays([[]])["rest_poses"].shape == (0, 4, 4)


def test_contacts_come_back() -> None:
    spans = [Span("jaw_left", "stone_1", 1.0, 2.5, 800.0), Span("boom", "terrain", 3.0, 3.0, 5.0)]
    back = spans_from(spans_as_array(spans), 0.5)
    assert back == [
        Span("jaw_left", "stone_1", 0.5, 2.0, 800.0),
        Span("boom", "terrain", 2.5, 2.5, 5.0),
    ]
    assert spans_from(spans_as_array([]), 0.5) == []


def test_a_mesh_of_moving_bodies_is_posed_body_by_body_and_one_of_none_is_empty() -> None:
    corner = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]])
    mesh = ArticulatedMesh.of([(2, corner), (0, corner)])
    assert mesh.owners.tolist() == [2, 2, 2, 0, 0, 0]
    turned = from_rpy(0.0, 0.0, np.pi / 2)
    rotations = np.array([turned, np.eye(3), np.eye(3)])
    positions = np.array([[0.0, 0, 5], [9, 9, 9], [3, 0, 0]])
    vertices, triangles = mesh.posed(positions, rotations, pose(turned, np.array([1.0, 0, 0])))
    # In the world: (3, 0, 0), (4, 0, 0), (3, 1, 0) and (0, 0, 5), (0, 1, 5), (−1, 0, 5).
    expected = [[0, -2, 0], [0, -3, 0], [1, -2, 0], [0, 1, 5], [1, 1, 5], [0, 2, 5]]
    np.testing.assert_allclose(vertices, expected, atol=1e-12)
    assert triangles.tolist() == [[0, 1, 2], [3, 4, 5]]
    low, high = mesh.boxes(vertices)
    np.testing.assert_allclose(low, [[0, -3, 0], [0, 1, 5]], atol=1e-12)
    np.testing.assert_allclose(high, [[1, -2, 0], [1, 2, 5]], atol=1e-12)
    none = ArticulatedMesh.of([])
    assert [corners.shape for corners in none.boxes(none.vertices)] == [(0, 3), (0, 3)]
    assert (none.vertices.shape, none.owners.shape, none.triangles.shape) == ((0, 3), (0,), (0, 3))
