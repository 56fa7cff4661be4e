"""Agglomeration of a signed graph: the pair with the largest mean weight is joined, until none is
positive (Bailoni et al. 2022, "GASP", with average linkage).

A single wrong edge joins nothing, as it would with connected components: a whole border decides.
"""

from heapq import heapify, heappop, heappush

import numpy as np
from executive_plugins.segmentation.union_find import set_labels
from numba import njit

from executive.arrays import Float, Int
from executive.errors import DataError


def average_linkage(count: int, pairs: Int, weights: Float) -> Int:
    """Return the group of each node, from 0 in order of the nodes, shape (count,).

    Args:
        count: Number of nodes.
        pairs: Nodes that are neighbours, each pair once, shape (E, 2).
        weights: Positive where they belong together, shape (E,).

    Raises:
        DataError: If there is not one weight for each pair.
    """
    if len(pairs) != len(weights):
        raise DataError(f"{len(weights)} weights for {len(pairs)} pairs of nodes")
    return np.asarray(_groups(count, np.sort(pairs, axis=1), weights))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _groups(count: int, pairs: Int, weights: Float) -> Int:
    """Join the groups on both sides of the border with the largest mean, until none is positive.

    Each border is in the chains of its two groups, by two numbers of which it is the half. Where a
    joined group has two borders with another, the first takes over the second, whose size is 0
    from then on. What the heap holds of a border that has changed since is passed over.
    """
    ends, sums, sizes = pairs.copy(), weights.copy(), np.ones(len(pairs), dtype=np.int64)
    firsts, following = _chains(count, pairs)
    heap = [(-weights[e], pairs[e, 0], pairs[e, 1], e) for e in range(len(pairs))]
    heapify(heap)
    parents, border_with = np.arange(count), np.full(count, -1)
    while len(heap):
        negative, a, b, e = heappop(heap)
        if negative >= 0:
            break
        if not sizes[e] or ends[e, 0] != a or ends[e, 1] != b or -sums[e] / sizes[e] != negative:
            continue
        parents[b], sizes[e] = a, 0
        _note(a, ends, sizes, (firsts, following), border_with)
        link = firsts[b]
        while link >= 0:
            this, link = link, following[link]
            e = this // 2
            if not sizes[e]:
                continue
            group = ends[e].sum() - b
            kept = border_with[group]
            if kept < 0:
                kept, ends[e, 0], ends[e, 1] = e, min(a, group), max(a, group)
                following[this], firsts[a] = firsts[a], this
            else:
                sums[kept], sizes[kept] = sums[kept] + sums[e], sizes[kept] + sizes[e]
                sizes[e] = 0
            heappush(heap, (-sums[kept] / sizes[kept], ends[kept, 0], ends[kept, 1], kept))
        border_with[:] = -1
    labels: Int = set_labels(parents, np.arange(count))
    return labels


@njit(cache=True)  # type: ignore[untyped-decorator]
def _chains(count: int, pairs: Int) -> tuple[Int, Int]:
    """Return the first link of each group's borders, and the link after each; −1 for none."""
    firsts, following = np.full(count, -1), np.empty(2 * len(pairs), dtype=np.int64)
    for link in range(2 * len(pairs)):
        group = pairs[link // 2, link % 2]
        following[link], firsts[group] = firsts[group], link
    return firsts, following


@njit(cache=True)  # type: ignore[untyped-decorator]
def _note(group: int, ends: Int, sizes: Int, chains: tuple[Int, Int], border_with: Int) -> None:
    """Note the border of a group with each neighbour; unchain those that were taken over."""
    firsts, following = chains
    link, firsts[group] = firsts[group], -1
    while link >= 0:
        this, link = link, following[link]
        if sizes[this // 2]:
            border_with[ends[this // 2].sum() - group] = this // 2
            following[this], firsts[group] = firsts[group], this
