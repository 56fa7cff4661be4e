"""Remove a stone's place from the map: for leaves after which the stone may lie elsewhere."""

from executive.interfaces.mapping import Mapper
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.context import Context
from executive.messages.stone import Stone

_MARGIN_M = 0.1  # beyond a stone's farthest point


def removal_radius(stone: Stone) -> float:
    """Return the distance [m] of a stone's farthest point from its centroid, plus a margin."""
    return stone.reach_m + _MARGIN_M


def remove_from_map(context: Context, stone: Stone, least_radius_m: float) -> tuple[int, int]:
    """Remove a sphere about a stone from the map (Mascaro et al. 2020, Sec. 4.5).

    Deviation from the paper: the sphere contains the whole stone, because what a long stone left
    outside of R_obj was segmented as another stone later. Beyond the paper: what the sphere takes
    from stones beside this one is put back from the database, because no scan may come before the
    next plan.

    Args:
        context: The leaf's view of the mission; it needs mapping and objects.
        stone: The stone whose place is removed.
        least_radius_m: R_obj [m].

    Returns:
        Number of points removed, and of those put back.
    """
    mapper, radius_m = context.use(Mapper), max(least_radius_m, removal_radius(stone))
    removed = mapper.remove_sphere(stone.centroid_map, radius_m)
    cut = context.use(ObjectDatabase).surface_within(stone.centroid_map, radius_m, stone.id)
    if len(cut):
        mapper.add_surface(cut)
    return removed, len(cut)
