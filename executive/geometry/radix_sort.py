"""The order of whole numbers by radix sort: a fifth of the time of sorting by comparison."""

import numpy as np
from numba import njit

from executive.arrays import Int

_BITS = 11  # of a digit: its 2048 counters stay in the processor's first cache
_ROOM = 62  # bits of a whole number that are free for a key and its row


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def radix_order(keys: Int) -> Int:  # pragma: no cover - compiled
    """Return the stable order of keys that are not negative, shape (N,)."""
    order: Int = radix_sorted(keys)[1]
    return order


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def radix_sorted(keys: Int) -> tuple[Int, Int]:  # pragma: no cover - compiled
    """Return keys that are not negative, sorted, and their stable order, each of shape (N,).

    Each key is sorted in one number with its row, so that memory is read in its order. Keys that
    leave no room for their rows are looked up by them, which takes half as long again.
    """
    shift, largest = 0, keys.max() if len(keys) else 0
    while len(keys) >> shift > 0:
        shift += 1
    if largest >> (_ROOM - shift) > 0:
        rows = _sorted_by(keys, np.arange(len(keys)), largest)
        return keys[rows], rows
    lower, upper = keys << shift, np.empty(len(keys), dtype=np.int64)
    for n in range(len(keys)):
        lower[n] |= n
    digit = shift
    while largest >> (digit - shift) > 0:
        starts = np.zeros((1 << _BITS) + 1, dtype=np.int64)
        for value in lower:
            starts[((value >> digit) & ((1 << _BITS) - 1)) + 1] += 1
        starts = np.cumsum(starts)
        for value in lower:
            place = (value >> digit) & ((1 << _BITS) - 1)
            upper[starts[place]] = value
            starts[place] += 1
        lower, upper = upper, lower
        digit += _BITS
    return lower >> shift, lower & ((1 << shift) - 1)


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def _sorted_by(keys: Int, order: Int, largest: int) -> Int:  # pragma: no cover - compiled
    """Return rows in the order of their keys."""
    other, shift = np.empty(len(keys), dtype=np.int64), 0
    while largest >> shift > 0:
        starts = np.zeros((1 << _BITS) + 1, dtype=np.int64)
        for n in order:
            starts[((keys[n] >> shift) & ((1 << _BITS) - 1)) + 1] += 1
        starts = np.cumsum(starts)
        for n in order:
            digit = (keys[n] >> shift) & ((1 << _BITS) - 1)
            other[starts[digit]] = n
            starts[digit] += 1
        order, other = other, order
        shift += _BITS
    return order
