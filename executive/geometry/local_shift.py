"""How far a survey lies off a map, from place to place.

A registration lays a survey over a map with one rigid motion. What is left is an error of that
motion, some centimetres, and the survey's own warp. Both change slowly over the site. Left so, each
stone that both show has two surfaces, and its hull is too large by their distance.
"""

from dataclasses import dataclass

import numpy as np

from executive.arrays import Bool, Float, Int

_CELL_M = 0.25  # of the grid of shifts
_SPACING_M = 0.05  # of the points that are compared
# Errors of points nearer than this to one another are the same: both surfaces are smoothed over a
# decimetre, one by the map's means, the other by the window of its plane sweep.
_CORRELATED_M = 0.15
_NEIGHBOURS = 12  # that span a normal
# Rounds of looking for partners: each about halves what is left. They end once nothing moves on.
_MOST_ROUNDS, _STILL_M = 12, 0.0005
_LEAST_NOISE_M = 0.005


@dataclass(frozen=True, slots=True, eq=False)
class LocalShift:
    """A shift for each place of the ground plan.

    Attributes:
        shifts: Of the cells of a grid, as they are to be added to a survey [m], shape (A, B, 3).
        corner: Where the grid begins in x and y [m], shape (2,).
        is_confirmed: Which of the survey's thinned points the map shows, too, shape (N,).
    """

    shifts: Float
    corner: Float
    is_confirmed: Bool

    @property
    def share(self) -> float:
        """Share of the survey that the map shows, too."""
        return float(self.is_confirmed.mean()) if len(self.is_confirmed) else 0.0

    def at(self, points: Float) -> Float:
        """Return the shifts of points (N, 3) [m], linear between the middles of cells, (N, 3)."""
        from scipy.ndimage import map_coordinates

        cells = ((points[:, :2] - self.corner) / _CELL_M - 0.5).T
        along = [
            map_coordinates(self.shifts[..., k], cells, order=1, mode="nearest") for k in range(3)
        ]
        return np.stack(along, axis=1)


def local_shift(survey: Float, reference: Float, std_m: float, width_m: float) -> LocalShift:
    """Fit the shifts that lay a survey onto a map where both show the same surface.

    Around each place, the shift minimises the squared distances of the survey's points from the
    planes of their nearest points of the map, weighted by a normal distribution around the place,
    with a shift of zero as prior knowledge. A direction that no surface there tells of, such as the
    horizontal ones on level ground, keeps the prior; distant points fade out. Large residuals
    count less (weights of a Cauchy distribution), since the survey shows sides that the map does
    not. The noise is that of the residuals themselves.

    Args:
        survey: Points in the frame of the map [m], shape (N, 3).
        reference: Points of the map [m], shape (M, 3).
        std_m: Standard deviation of the shift along each axis, known before [m]; partners are
            looked for within three of it.
        width_m: Standard deviation of the weight around a place [m]: within it, the shift hardly
            changes.
    """
    from executive.geometry.voxels import voxel_means  # reading a mission imports no algorithm

    points, surface = voxel_means(survey, _SPACING_M), voxel_means(reference, _SPACING_M)
    if not len(points) or len(surface) < _NEIGHBOURS:
        return LocalShift(np.zeros((1, 1, 3)), np.zeros(2), np.zeros(len(points), dtype=bool))
    from scipy.spatial import cKDTree

    tree = cKDTree(surface)
    normals = _normals(surface, tree.query(surface, k=_NEIGHBOURS)[1])
    corner = points[:, :2].min(axis=0) - _CELL_M
    cells = np.floor((points[:, :2] - corner) / _CELL_M).astype(int)
    shape = tuple(cells.max(axis=0) + 2)
    fitted = LocalShift(np.zeros((*shape, 3)), corner, np.zeros(len(points), dtype=bool))
    for _ in range(_MOST_ROUNDS):
        moved = points + fitted.at(points)
        distances, nearest = tree.query(moved, distance_upper_bound=3 * std_m)
        near = np.isfinite(distances)
        partners = nearest[near]
        n, apart = normals[partners], surface[partners]
        residuals = np.einsum("ij,ij->i", n, apart - moved[near])
        wanted = np.einsum("ij,ij->i", n, apart - points[near])
        shifts = _solved(cells[near], n, wanted, residuals, shape, std_m, width_m)
        change_m = float(np.abs(shifts - fitted.shifts).max())
        fitted = LocalShift(shifts, corner, near)
        if change_m < _STILL_M:
            break
    return fitted


def _normals(surface: Float, neighbours: Int) -> Float:
    """Return a unit normal of each point, of either sign, shape (M, 3)."""
    patch = surface[neighbours] - surface[neighbours].mean(axis=1, keepdims=True)
    return np.asarray(np.linalg.eigh(patch.transpose(0, 2, 1) @ patch)[1][:, :, 0])


def _solved(
    cells: Int,
    normals: Float,
    wanted: Float,
    residuals: Float,
    shape: tuple[int, ...],
    std_m: float,
    width_m: float,
) -> Float:
    """Return the shift of each cell from what its surroundings ask for, shape (A, B, 3).

    Args:
        cells: Of the points, shape (K, 2).
        normals: Of their partners, shape (K, 3).
        wanted: Distance of each unshifted point from its partner's plane [m], shape (K,).
        residuals: The same after the shift so far [m], shape (K,).
        shape: Of the grid.
        std_m, width_m: See `local_shift`.
    """
    from scipy.ndimage import gaussian_filter

    noise_m = max(
        1.4826 * float(np.median(np.abs(residuals))) if len(residuals) else 0.0, _LEAST_NOISE_M
    )
    weights = 1.0 / (1.0 + (residuals / noise_m) ** 2)
    information, wish = np.zeros((*shape, 3, 3)), np.zeros((*shape, 3))
    at = (cells[:, 0], cells[:, 1])
    np.add.at(information, at, weights[:, None, None] * normals[:, :, None] * normals[:, None, :])
    np.add.at(wish, at, (weights * wanted)[:, None] * normals)
    blur = width_m / _CELL_M
    # `gaussian_filter` has a sum of 1; the weight at the place itself is to be 1. Points within a
    # correlation length count as one.
    of_one = 2 * np.pi * blur**2 * (_SPACING_M / _CORRELATED_M) ** 2 / noise_m**2
    information = of_one * gaussian_filter(information, (blur, blur, 0, 0), mode="constant")
    wish = of_one * gaussian_filter(wish, (blur, blur, 0), mode="constant")
    information += np.eye(3) / std_m**2
    return np.asarray(np.linalg.solve(information, wish[..., None])[..., 0])
