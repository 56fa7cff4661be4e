"""What a leaf drives: two leaves that drive the same part must not run at the same time."""

from enum import StrEnum

from executive.machine.machine import Machine


class Part(StrEnum):
    """A part of a machine that one leaf at a time may drive.

    A machine with further parts, such as a second arm, names them by plain texts.
    """

    ARM = "arm"
    CABIN = "cabin"
    JAWS = "jaws"
    LIDARS = "lidars"
    WHEELS = "wheels"
    MACHINE = "machine"  # the whole of it: overlaps with each other part


def common(first: tuple[str, ...], second: tuple[str, ...]) -> tuple[str, ...]:
    """Return the parts that both drive; the whole machine shares every part of the other."""
    if Part.MACHINE in first:
        return second
    if Part.MACHINE in second:
        return first
    return tuple(part for part in first if part in second)


def joints_of(parts: tuple[str, ...], machine: Machine) -> tuple[str, ...]:
    """Return the joints that come to rest along a path when a leaf that drives parts is cancelled.

    The jaws are none of them: another command of theirs replaces the one before at any moment. A
    part of a name that is not in `Part` may be any joint of the arm.
    """
    if all(part in (Part.JAWS, Part.LIDARS) for part in parts):
        return ()
    if all(part in (Part.JAWS, Part.LIDARS, Part.CABIN) for part in parts):
        return (machine.turn_joint,)
    if Part.ARM in parts and all(part in (Part.ARM, Part.JAWS, Part.LIDARS) for part in parts):
        return tuple(name for name in machine.arm_names if name != machine.turn_joint)
    return machine.arm_names
