"""The form of a structure as settings: its centre line, and what is refused."""

import numpy as np
import pytest
from pydantic import ValidationError

from executive.leaf.structure_shape import RingShape, StructureShape


def test_a_line_is_kept_with_what_is_said_of_the_wall() -> None:
    line = ((-2.0, 6.0), (2.0, 6.0))
    wall = StructureShape(line=line, thickness=1.2, height=0.9, batter=0.1, faces=1).shaped("a")
    assert wall.line.tolist() == [[-2.0, 6.0], [2.0, 6.0]]
    assert (wall.name, wall.thickness_m, wall.height_m) == ("a", 1.2, 0.9)
    assert (wall.batter_rad, wall.faces, wall.is_ring) == (0.1, 1, False)


def test_what_is_not_said_is_a_usual_wall() -> None:
    wall = StructureShape(line=((0.0, 0.0), (1.0, 0.0))).shaped("wall")
    assert (wall.thickness_m, wall.height_m, wall.batter_rad, wall.faces) == (1.3, 1.5, 0.0, 2)


def test_a_ring_is_a_closed_circle_of_48_corners() -> None:
    ring = StructureShape(ring=RingShape(centre=(3.0, -1.0), radius=2.5)).shaped("ring")
    assert ring.line.shape == (49, 2)
    assert ring.is_ring
    assert ring.line[0].tolist() == ring.line[-1].tolist() == [5.5, -1.0]
    away = np.linalg.norm(ring.line - [3.0, -1.0], axis=1)
    np.testing.assert_allclose(away, 2.5)
    np.testing.assert_allclose(ring.line[12], [3.0, 1.5], atol=1e-12)  # a quarter, to the left
    sides = np.linalg.norm(np.diff(ring.line, axis=0), axis=1)
    np.testing.assert_allclose(sides, 2 * 2.5 * np.sin(np.pi / 48))
    assert RingShape() == RingShape(centre=(0.0, 0.0), radius=2.0)


def test_a_cairn_is_a_point() -> None:
    cairn = StructureShape.model_validate({"cairn": (1.0, 2.0)}).shaped("cairn")
    assert cairn.line.tolist() == [[1.0, 2.0]]


@pytest.mark.parametrize(
    ("name", "good", "bad"),
    [
        ("thickness", (0.1, 50.0), (0.0, 50.1)),
        ("height", (0.1, 50.0), (0.0, 50.1)),
        ("batter", (0.0, 0.1), (-0.1, 0.8)),
    ],
)
def test_sizes_have_bounds(name: str, good: tuple, bad: tuple) -> None:
    given = {"cairn": (0.0, 0.0), "thickness": 40.0}
    for value in good:
        assert getattr(StructureShape(**{**given, name: value}), name) == value
    for value in bad:
        with pytest.raises(ValidationError, match=name):
            StructureShape(**{**given, name: value})


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ({}, "one of line, ring, cairn; got none"),
        ({"cairn": (0, 0), "ring": RingShape()}, "one of line, ring, cairn; got ring and cairn"),
        ({"cairn": (0, 0), "batter": 0.7, "height": 3.0}, "faces meet below its top"),
        ({"line": ((0, 0), (0, 0))}, "two successive points of its line are one"),
        ({"line": ((0, 0),)}, "at least 2"),
    ],
)
def test_what_is_no_structure_is_refused(said: dict, told: str) -> None:
    with pytest.raises(ValidationError, match=told):
        StructureShape(**said)
