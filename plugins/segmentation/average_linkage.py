"""Agglomeration of a signed graph: the pair with the largest mean weight is joined, until none is
positive (Bailoni et al. 2022, "GASP", with average linkage).

A single wrong edge joins nothing, as it would with connected components: a whole border decides.
"""

import heapq

import numpy as np

from executive.arrays import Float, Int
from executive.errors import DataError

Border = tuple[float, int]  # sum of the weights between two groups, and their number


def average_linkage(count: int, pairs: Int, weights: Float) -> Int:
    """Return the group of each node, from 0 in order of the nodes, shape (count,).

    Args:
        count: Number of nodes.
        pairs: Nodes that are neighbours, shape (E, 2).
        weights: Positive where they belong together, shape (E,).

    Raises:
        DataError: If there is not one weight for each pair.
    """
    if len(pairs) != len(weights):
        raise DataError(f"{len(weights)} weights for {len(pairs)} pairs of nodes")
    borders: list[dict[int, Border]] = [{} for _ in range(count)]
    heap = []
    for (a, b), weight in zip(pairs.tolist(), weights.tolist(), strict=True):
        borders[a][b] = borders[b][a] = (weight, 1)
        heap.append((-weight, a, b))
    heapq.heapify(heap)
    parents = np.arange(count)
    while heap:
        negative, a, b = heapq.heappop(heap)
        if negative >= 0:
            break
        border = borders[a].get(b)
        if border is None or -border[0] / border[1] != negative:
            continue  # one of the two has been joined since
        for group, (weight, size) in borders[b].items():
            del borders[group][b]
            if group != a:
                before = borders[a].get(group, (0.0, 0))
                joined = (before[0] + weight, before[1] + size)
                borders[a][group] = borders[group][a] = joined
                heapq.heappush(heap, (-joined[0] / joined[1], *sorted((a, group))))
        borders[b] = {}
        parents[b] = a
    for node in range(count):
        root = node
        while parents[root] != root:
            root = int(parents[root])
        parents[node] = root
    return np.asarray(np.unique(parents, return_inverse=True)[1].reshape(-1))
