"""Inertia and corners of links whose integrals are known."""

import numpy as np

from executive.machine.link import Link
from executive.machine.shape import Shape


def test_the_inertia_of_a_box_is_that_of_its_volume_integral() -> None:
    """I_xx = ∫ (y² + z²) dm, here as a mean over cells of equal mass."""
    sides = np.array([2.0, 1.0, 0.5])
    link = Link(
        name="box",
        mass_kg=30.0,
        com_m=(0.0, 0.0, 0.0),
        shapes=(Shape(kind="box", size=tuple(sides)),),
        provenance="guess",
    )
    cells = [(np.arange(100) + 0.5) / 100 * side - side / 2 for side in sides]
    squares = np.array([(axis**2).mean() for axis in cells])
    expected = 30.0 * (squares.sum() - squares)
    np.testing.assert_allclose(link.inertia_diagonal, expected, rtol=1e-3)


def test_the_prism_of_a_cylinder_encloses_it() -> None:
    corners = Shape(kind="cylinder", size=(0.3, 1.0)).vertices
    ring = corners[corners[:, 2] > 0][:, :2]
    middles = (ring + np.roll(ring, 1, axis=0)) / 2
    np.testing.assert_allclose(np.linalg.norm(middles, axis=1), 0.3)
    np.testing.assert_allclose(np.ptp(corners[:, 2]), 1.0)
