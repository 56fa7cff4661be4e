"""What a leaf drives: two leaves that drive the same part must not run at the same time."""

from enum import StrEnum


class Part(StrEnum):
    """A part of a machine that one leaf at a time may drive.

    A machine with further parts, such as a second arm, names them by plain texts.
    """

    ARM = "arm"
    CABIN = "cabin"
    JAWS = "jaws"
    LIDARS = "lidars"
    MACHINE = "machine"  # the whole of it: overlaps with each other part


def common(first: tuple[str, ...], second: tuple[str, ...]) -> tuple[str, ...]:
    """Return the parts that both drive; the whole machine shares every part of the other."""
    if Part.MACHINE in first:
        return second
    if Part.MACHINE in second:
        return first
    return tuple(part for part in first if part in second)
