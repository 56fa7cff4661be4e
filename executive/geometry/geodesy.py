"""Geodetic coordinates (WGS-84) to and from a local east-north-up frame about a datum."""

import numpy as np

from executive.arrays import Float

_A_M = 6378137.0  # semi-major axis of WGS-84
_F = 1 / 298.257223563  # flattening
_E2 = _F * (2 - _F)


def ecef(latitude_deg: float, longitude_deg: float, altitude_m: float) -> Float:
    """Return earth-centred, earth-fixed coordinates [m], shape (3,)."""
    lat, lon = np.radians(latitude_deg), np.radians(longitude_deg)
    n = _A_M / np.sqrt(1 - _E2 * np.sin(lat) ** 2)
    return np.array(
        [
            (n + altitude_m) * np.cos(lat) * np.cos(lon),
            (n + altitude_m) * np.cos(lat) * np.sin(lon),
            (n * (1 - _E2) + altitude_m) * np.sin(lat),
        ]
    )


def _R_enu_ecef(latitude_deg: float, longitude_deg: float) -> Float:
    lat, lon = np.radians(latitude_deg), np.radians(longitude_deg)
    return np.array(
        [
            [-np.sin(lon), np.cos(lon), 0.0],
            [-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)],
            [np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)],
        ]
    )


def enu_from_geodetic(geodetic: Float, datum: Float) -> Float:
    """Return east, north, up of a geodetic position about a datum [m], shape (3,).

    Args:
        geodetic: Latitude [deg], longitude [deg], altitude above the ellipsoid [m], shape (3,).
        datum: Origin of the local frame, in the same form, shape (3,).
    """
    return np.asarray(_R_enu_ecef(datum[0], datum[1]) @ (ecef(*geodetic) - ecef(*datum)))


def geodetic_from_enu(enu_m: Float, datum: Float) -> Float:
    """Return latitude [deg], longitude [deg] and altitude [m] of a local point, shape (3,).

    Exact to 1e-9 m near the earth.

    Args:
        enu_m: East, north, up about the datum [m], shape (3,).
        datum: Latitude [deg], longitude [deg], altitude above the ellipsoid [m], shape (3,).
    """
    x, y, z = ecef(*datum) + _R_enu_ecef(datum[0], datum[1]).T @ enu_m
    p = np.hypot(x, y)
    lat = np.arctan2(z, p * (1 - _E2))
    for _ in range(6):  # the error shrinks by e² = 0.0067 a step: 0.0067⁶ is below rounding
        n = _A_M / np.sqrt(1 - _E2 * np.sin(lat) ** 2)
        lat = np.arctan2(z + _E2 * n * np.sin(lat), p)
    n = _A_M / np.sqrt(1 - _E2 * np.sin(lat) ** 2)
    altitude = p * np.cos(lat) + z * np.sin(lat) - _A_M**2 / n
    return np.array([np.degrees(lat), np.degrees(np.arctan2(y, x)), altitude])


def T_enu_enu(datum: Float, other: Float) -> Float:
    """Return the pose of one local frame in another, p_datum = T @ p_other, shape (4, 4).

    It is exact: both are axes in space, turned against each other by the curvature of the earth.

    Args:
        datum: Latitude [deg], longitude [deg], altitude above the ellipsoid [m], shape (3,).
        other: The same of the other frame, shape (3,).
    """
    T = np.eye(4)
    T[:3, :3] = _R_enu_ecef(datum[0], datum[1]) @ _R_enu_ecef(other[0], other[1]).T
    T[:3, 3] = enu_from_geodetic(other, datum)
    return T
