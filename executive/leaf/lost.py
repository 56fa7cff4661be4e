"""Stones that are not where they were believed to be."""

from executive.events.stone import StoneLost
from executive.interfaces.objects import ObjectDatabase
from executive.leaf.context import Context
from executive.messages.stone import Stone, StoneState


def lost_stones(context: Context) -> tuple[Stone, ...]:
    """Return the stones that are lost, by id."""
    stones = context.use(ObjectDatabase).stones()
    return tuple(stone for stone in stones if stone.state is StoneState.LOST)


def mark_lost(context: Context, stone_id: int, reason: str) -> None:
    """Note that nobody knows where a stone is; its pose in the database is only its last one.

    Args:
        context: The leaf's view of the mission; it needs objects.
        stone_id: Id of the stone; one that is lost already is not reported again.
        reason: What is known, for a person.
    """
    objects = context.use(ObjectDatabase)
    if objects.stone(stone_id).state is not StoneState.LOST:
        objects.set_state(stone_id, StoneState.LOST, context.now_s())
        context.record(StoneLost(stone_id, reason))
