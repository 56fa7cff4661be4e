"""The order of whole numbers by radix sort: a fifth of the time of sorting by comparison."""

import numpy as np
from numba import njit

from executive.arrays import Int

_BITS = 11  # of a digit: its 2048 counters stay in the processor's first cache


@njit(cache=True, nogil=True)  # type: ignore[untyped-decorator]
def radix_order(keys: Int) -> Int:  # pragma: no cover - compiled
    """Return the stable order of keys that are not negative, shape (N,)."""
    order, other = np.arange(len(keys)), np.empty(len(keys), dtype=np.int64)
    largest = keys.max() if len(keys) else 0
    shift = 0
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
