"""Reads the seeds of a campaign: a number, a range whose last seed is included, or a list."""

import re

from executive.tree.reading import Reading
from executive.tree.value import Broken, Listing, Scalar, Value, describe

MOST = 1_000_000  # seeds, and trials: a campaign of more is hardly meant
_RANGE = re.compile(r"(\d{1,20}):(\d{1,20})")  # int() refuses more than 4,300 digits


def read_seeds(value: Value, reading: Reading) -> tuple[int, ...]:
    """Return the seeds in the order in which they are given; none after a mistake was noted."""
    if isinstance(value, Listing) and not reading.listing(value, "'seeds'"):
        return ()
    items = value.items if isinstance(value, Listing) else (value,)
    seeds: list[int] = []
    known: set[int] = set()
    for item in items:
        for seed in _seeds_of(item, reading):
            if seed in known:
                reading.fail(item, f"seed {seed} is given twice")
                break
            known.add(seed)
            seeds.append(seed)
    return tuple(seeds)


def _seeds_of(item: Value, reading: Reading) -> range:
    got = item.value if isinstance(item, Scalar) else None
    if isinstance(got, int) and not isinstance(got, bool) and got >= 0:
        return range(got, got + 1)
    match = _RANGE.fullmatch(got.strip()) if isinstance(got, str) else None
    if match is None:
        _refuse(item, reading)
        return range(0)
    first, last = map(int, match.groups())
    if first > last:
        reading.fail(item, f"the range ends before it begins; write {last}:{first}")
        return range(0)
    if last - first >= MOST:
        reading.fail(item, f"more than {MOST:,} seeds")
        return range(0)
    return range(first, last + 1)


def _refuse(item: Value, reading: Reading) -> None:
    if not isinstance(item, Broken):
        told = f"a seed is a whole number from 0, or a range such as 1:20, not {describe(item)}"
        reading.fail(item, told)
