"""Geodesy: there and back, known lengths, known directions."""

import numpy as np
import pytest

from executive.geometry.geodesy import T_enu_enu, ecef, enu_from_geodetic, geodetic_from_enu
from executive.geometry.pose import transform

DATUM = np.array([47.4084, 8.5106, 440.0])


def test_the_equator_and_the_pole_are_where_wgs_84_has_them() -> None:
    np.testing.assert_allclose(ecef(0, 0, 0), [6378137.0, 0, 0])
    np.testing.assert_allclose(ecef(90, 0, 0), [0, 0, 6356752.314245], atol=1e-6)
    np.testing.assert_allclose(ecef(0, 90, 100), [0, 6378237.0, 0], atol=1e-6)


@pytest.mark.parametrize(
    "enu", [[0, 0, 0], [10, -20, 5], [-3000, 4000, 200], [0.001, 0.002, -0.003]]
)
def test_there_and_back_is_the_same_point(enu: list[float]) -> None:
    geodetic = geodetic_from_enu(np.array(enu, dtype=float), DATUM)
    np.testing.assert_allclose(enu_from_geodetic(geodetic, DATUM), enu, atol=1e-7)


def test_the_datum_is_the_origin() -> None:
    np.testing.assert_array_equal(enu_from_geodetic(DATUM, DATUM), np.zeros(3))
    np.testing.assert_allclose(geodetic_from_enu(np.zeros(3), DATUM), DATUM, atol=1e-9)


def test_axes_point_east_north_and_up() -> None:
    for axis, change in enumerate(([0, 1e-4, 0], [1e-4, 0, 0], [0, 0, 10.0])):
        geodetic = DATUM + np.array([change[0], change[1], change[2]])
        enu = enu_from_geodetic(geodetic, DATUM)
        assert np.argmax(np.abs(enu)) == axis
        assert enu[axis] > 0


def test_a_degree_of_latitude_at_zurich_has_the_ellipsoids_length() -> None:
    # M = a (1 − e²) / (1 − e² sin² φ)^1.5: the meridian's radius of curvature.
    e2 = 0.00669437999014
    radius = 6378137 * (1 - e2) / (1 - e2 * np.sin(np.radians(DATUM[0])) ** 2) ** 1.5 + DATUM[2]
    north = enu_from_geodetic(DATUM + np.array([1e-3, 0, 0]), DATUM)[1]
    assert north == pytest.approx(np.radians(1e-3) * radius, rel=1e-5)


def test_a_point_of_one_local_frame_is_the_same_place_in_another() -> None:
    other = np.array([47.5, 8.6, 500.0])
    points = np.random.default_rng(3).uniform(-500, 500, (20, 3))
    expected = [enu_from_geodetic(geodetic_from_enu(point, other), DATUM) for point in points]
    np.testing.assert_allclose(transform(T_enu_enu(DATUM, other), points), expected, atol=1e-6)
    np.testing.assert_allclose(T_enu_enu(DATUM, DATUM), np.eye(4), atol=1e-12)
