"""Whether a stone was seen since it was let go, by the database's own history."""

from executive.interfaces.objects import ObjectDatabase

SIGHTINGS = frozenset({"realign", "seen", "moved", "replaced"})  # of events after a stone was seen
_RELEASE, _REPLACED = "release", "replaced"
_FOUND, _RESHAPED = "found", "reshaped"


def sightings(objects: ObjectDatabase, stone: int) -> frozenset[str]:
    """Return the kinds of sightings of a stone since its last release, or ever without one."""
    kinds = [event.kind for event in objects.history(stone)]
    since = len(kinds) - kinds[::-1].index(_RELEASE) if _RELEASE in kinds else 0
    return SIGHTINGS.intersection(kinds[since:])


def is_turn_known(objects: ObjectDatabase, stone: int) -> bool:
    """Return whether a stone's pose tells how it is turned against the stone as it was found.

    A stone that turned over shows an underside that nobody has seen. Where no known surface is
    recognised, what is seen becomes its model, and the angle between the two is not known.
    """
    return all(event.kind != _REPLACED for event in objects.history(stone))


def is_underside_known(objects: ObjectDatabase, stone: int) -> bool:
    """Return whether the lower half of a stone's model was seen, as it hung in the jaws."""
    shapes = (_FOUND, _REPLACED, _RESHAPED)
    kinds = [event.kind for event in objects.history(stone) if event.kind in shapes]
    return kinds[-1:] == [_RESHAPED]
