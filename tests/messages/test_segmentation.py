"""A segmentation of which some parts are told as moving."""

import numpy as np

from executive.arrays import Float
from executive.messages.cloud import Cloud
from executive.messages.segment import LeftOut, PartKind, Segment, Segmentation

UP = np.array([0.0, 0.0, 1.0, 0.0])


def at(x: float, count: int) -> Float:
    return np.column_stack([np.full(count, x), np.zeros(count), np.linspace(0, 1, count)])


def segment(number: int, x: float, count: int) -> Segment:
    points = at(x, count)
    return Segment(number, points, points.mean(axis=0), np.ones(3))


def left_out(kind: PartKind, x: float, count: int, surface: Float) -> LeftOut:
    return LeftOut(kind, "as it was", count, at(x, count).mean(axis=0), np.ones(3), surface)


FOUND = Segmentation(
    "map",
    (segment(0, 5.0, 9), segment(1, 1.0, 6), segment(2, 6.0, 4)),
    Cloud("map", np.zeros((1, 3))),
    UP,
    (
        left_out(PartKind.STRUCTURE, 7.0, 20, at(7.0, 20)),
        left_out(PartKind.STACK, 1.5, 8, at(1.5, 8)),
        left_out(PartKind.UNKNOWN, 8.0, 5, np.zeros((0, 3))),
    ),
)


def test_what_moves_is_left_out_and_the_rest_keeps_its_order() -> None:
    told = FOUND.leaving_out(PartKind.MOVING, lambda points: "walks" if points[0, 0] > 4.5 else "")
    assert [(one.id, len(one.points)) for one in told.segments] == [(0, 6)]
    assert [(str(one.kind), one.points, one.reason) for one in told.left_out] == [
        ("moving", 20, "walks"),
        ("moving", 9, "walks"),
        ("stack", 8, "as it was"),
        ("unknown", 5, "as it was"),  # a method that does not tell its points is believed
        ("moving", 4, "walks"),
    ]
    moved = told.left_out[1]
    np.testing.assert_array_equal(moved.surface, FOUND.segments[0].points)
    np.testing.assert_array_equal(moved.centroid, FOUND.segments[0].centroid)


def test_where_nothing_moves_it_is_the_same() -> None:
    assert FOUND.leaving_out(PartKind.MOVING, lambda points: "") is FOUND
