"""What a segment says of a known stone: seen, moved or replaced, and the surface that follows."""

from dataclasses import dataclass

from executive_plugins.objects.growth import Fit, fit_of, icp_shift, merged, shifts_of
from executive_plugins.objects.settings import SqliteObjectsSettings

from executive.arrays import Float
from executive.geometry.pose import inverse, pose, transform
from executive.messages.segment import Segment
from executive.messages.stone import Stone


@dataclass(frozen=True, slots=True, eq=False)
class Sighting:
    """A known stone, compared with the segment that is taken for it.

    Attributes:
        kind: `seen` where it was, `moved` without turning, or `replaced`: it was turned, and the
            seen surface takes the place of the known one.
        fit: How well the segment fits the model where it was found.
        T_map_object: The stone's pose, shape (4, 4); a replaced one follows the centroid, while its
            rotation is unknown.
        points_object: The merged surface in the object's frame [m], shape (N, 3).
        is_too_large: Whether the box would grow too much: such a segment is two stones in one, and
            nothing of it may be used.
    """

    kind: str
    fit: Fit
    T_map_object: Float
    points_object: Float
    is_too_large: bool


def sighting_of(stone: Stone, segment: Segment, settings: SqliteObjectsSettings) -> Sighting:
    """Compare a stone with a segment, and merge their surfaces."""
    known, seen, T = stone.points_map, segment.points, stone.T_map_object
    kind, fit = "seen", _fit(known, seen, settings)
    if not _agrees(fit, settings):
        shift, there = _moved(known, seen, settings)
        is_whole = _agrees(there, settings)
        kind, fit = ("moved", there) if is_whole else ("replaced", fit)
        known, T = (known + shift if is_whole else known[:0]), pose(T[:3, :3], T[:3, 3] + shift)
    limit = settings.max_growth_whole if stone.seen_from_above else settings.max_growth
    is_too_large = kind != "replaced" and fit.growth > limit
    T_object_map = inverse(T)
    parts = (transform(T_object_map, known), transform(T_object_map, seen))
    points = merged(*parts, settings.voxel_m, settings.max_points)
    return Sighting(kind, fit, T, points, is_too_large)


def is_same_surface(stone: Stone, segment: Segment, settings: SqliteObjectsSettings) -> bool:
    """Return whether a segment fits a stone that lies where it was, or moved without turning."""
    return sighting_of(stone, segment, settings).kind != "replaced"


def _moved(known: Float, seen: Float, settings: SqliteObjectsSettings) -> tuple[Float, Fit]:
    """Return the shift of a stone that moved without turning, shape (3,) [m], and its fit.

    The shift is estimated by means, by boxes and by ICP; the best fit counts, or the means if none
    fits.
    """
    by_mean, by_box = shifts_of(known, seen, settings.voxel_m)
    by_icp = icp_shift(known, seen, settings.agreement_m)
    fits = [(shift, _fit(known + shift, seen, settings)) for shift in (by_mean, by_box, by_icp)]
    shift, fit = max(fits, key=lambda one: (_agrees(one[1], settings), -one[1].rmse_m))
    return (shift, fit) if _agrees(fit, settings) else fits[0]


def _fit(known: Float, seen: Float, settings: SqliteObjectsSettings) -> Fit:
    return fit_of(known, seen, settings.agreement_m)


def _agrees(fit: Fit, settings: SqliteObjectsSettings) -> bool:
    return fit.share >= settings.min_agreement and fit.rmse_m <= settings.max_rmse_m
