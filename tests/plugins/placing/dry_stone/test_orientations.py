"""Stones are turned from where their length lies along the structure, and lie square to it."""

from itertools import product

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.orientations import orientations
from executive_plugins.placing.dry_stone.settings import GeneratorSettings

from executive.arrays import Float
from executive.geometry.rotation import about_axis

HEADING_RAD = 0.3  # of the structure
UP = np.array([0.0, 0.0, 1.0])


def block(lies_rad: float, dense: int = 0) -> Float:
    """Return corners of a block of 1.2 × 0.7 × 0.5 m as it lies, and more on one edge, (V, 3)."""
    corners = np.array(list(product((-0.6, 0.6), (-0.35, 0.35), (-0.25, 0.25))))
    edge = np.linspace(corners[0], corners[-1] * (1, 1, -1), dense)  # a diagonal of its underside
    return np.vstack([corners, edge]) @ about_axis(UP, lies_rad).T


def headings_rad(vertices: Float, turns: int) -> Float:
    """Return how far its length is off the structure's at each turn, from −π/2 to π/2, (turns,)."""
    length = np.array([1.0, 0.0, 0.0])
    found = [R @ length for R in orientations(vertices, None, turns, HEADING_RAD)]
    off = np.array([np.arctan2(one[1], one[0]) for one in found]) - HEADING_RAD
    return np.asarray((off + np.pi / 2) % np.pi - np.pi / 2)


@pytest.mark.parametrize(("turns", "is_square"), [(GeneratorSettings().turns, True), (10, False)])
def test_turns_lay_a_stone_straight_across_the_structure(turns: int, is_square: bool) -> None:
    off = np.abs(headings_rad(block(0.0), turns))
    assert off.min() == pytest.approx(0.0, abs=1e-9)
    assert (off.max() == pytest.approx(np.pi / 2)) == is_square


@pytest.mark.parametrize("lies_rad", [0.0, 0.4, 2.0])
def test_the_length_is_that_of_the_smallest_rectangle_however_points_are_spread(
    lies_rad: float,
) -> None:
    """A scan has more points on one side than on another, and that says nothing about its shape."""
    (R,) = orientations(block(lies_rad, dense=50), None, 1, HEADING_RAD)
    ways = R @ about_axis(UP, lies_rad)
    off = np.arctan2(ways[1, 0], ways[0, 0]) - HEADING_RAD
    assert (off + np.pi / 2) % np.pi == pytest.approx(np.pi / 2)
