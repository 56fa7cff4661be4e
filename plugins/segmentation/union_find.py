"""Disjoint sets in an array of parents: a root is its own parent."""

import numpy as np
from numba import njit

from executive.arrays import Int


@njit(cache=True)  # type: ignore[untyped-decorator]
def root_of(parents: Int, member: int) -> int:
    """Return the root of a member's set; halves the path to it on the way."""
    while parents[member] != member:
        parents[member] = parents[parents[member]]
        member = parents[member]
    return member


@njit(cache=True)  # type: ignore[untyped-decorator]
def set_labels(parents: Int, members: Int) -> Int:
    """Return the number of each member's set, counted from 0 in order of appearance, shape (N,)."""
    numbers, count = np.full(len(parents), -1), 0
    labels = np.empty(len(members), dtype=np.int64)
    for i in range(len(members)):
        root = root_of(parents, members[i])
        if numbers[root] < 0:
            numbers[root] = count
            count += 1
        labels[i] = numbers[root]
    return labels
