"""Reads the limits of a run: `{time: 20 min, memory: 4 GB}`."""

from executive.campaign.trial import Limits
from executive.config import parse_quantity
from executive.tree.reading import Reading
from executive.tree.value import Scalar, Table, Value, describe

KEYS = ("time", "memory")
# Without a limit a run that hangs would hold its process for ever. No shipped mission needs more.
DEFAULT = Limits(time_s=3600.0, memory_bytes=8_000_000_000)
LEAST_MEMORY_BYTES = 100_000_000  # Python with its numerical libraries takes as much


def read_limits(table: Table | None, reading: Reading) -> Limits:
    """Return the limits; the default stands for one that is absent or wrong."""
    if table is None:
        return DEFAULT
    reading.known_keys(table, KEYS, "'limits'")
    time, memory = table.get("time"), table.get("memory")
    time_s = None if time is None else reading.seconds(time, "'time'")
    size = None if memory is None else _bytes(memory, reading)
    return Limits(time_s or DEFAULT.time_s, size or DEFAULT.memory_bytes)


def _bytes(value: Value, reading: Reading) -> int | None:
    if not isinstance(value, Scalar):
        reading.fail(value, f"'memory' is a size such as 4 GB, not {describe(value)}")
        return None
    try:
        size = parse_quantity(value.value, "data size")
    except ValueError as error:
        reading.fail(value, f"'memory': {error}")
        return None
    if LEAST_MEMORY_BYTES <= size < float("inf"):
        return int(size)
    least = f"{LEAST_MEMORY_BYTES / 1e6:.0f} MB"
    reading.fail(value, f"'memory' must be at least {least}, or no run could begin, got {size:g} B")
    return None
