"""Elimination of a chain of nodes by QR, oldest first, that reuses earlier results."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import gtsam
from executive_plugins.estimation.factors import clock_key, keys

_INDEX = (1 << 56) - 1  # the last 56 bits of a key number its node; the first 8 are its letter


def node_of(key: int) -> int:
    """Return the node that a key belongs to."""
    return key & _INDEX


def nodes_of(factor: gtsam.NonlinearFactor | gtsam.GaussianFactor) -> frozenset[int]:
    """Return the nodes that a factor touches."""
    return frozenset(key & _INDEX for key in factor.keys())  # noqa: SIM118 - a factor is not a mapping


@dataclass(frozen=True, slots=True, eq=False)
class Eliminated:
    """A node that was eliminated.

    Attributes:
        node: The node.
        conditional: Density of the node given its parents.
        remainder: Factor on the parents that the elimination leaves.
        parents: The later nodes that the node depends on; none for the last.
    """

    node: int
    conditional: gtsam.GaussianConditional
    remainder: gtsam.JacobianFactor
    parents: frozenset[int]


class GraphChain:
    """The nodes eliminated so far, oldest first.

    New measurements concern the newest few of some sixty nodes, and the elimination of the nodes
    before them stays valid. An update hence costs as much as its new measurements, not as much as
    the window. The idea is that of iSAM2 (Kaess 2012), whose tree is a chain here, so that a list
    suffices. Unlike there, a node may be inserted anywhere.
    """

    def __init__(self, has_clock: bool = False) -> None:
        """Make one without nodes; `has_clock` says whether each has a clock."""
        self._has_clock = has_clock
        self._done: list[Eliminated] = []

    def __len__(self) -> int:
        return len(self._done)

    def copy(self) -> "GraphChain":
        """Return an independent chain with the same content."""
        twin = GraphChain(self._has_clock)
        twin._done = self._done.copy()
        return twin

    def void_from(self, rank: int) -> None:
        """Undo the elimination of the node at a rank and of all newer nodes."""
        del self._done[max(rank, 0) :]

    def drop(self, count: int) -> list[gtsam.JacobianFactor]:
        """Remove the oldest nodes; return their marginal, as factors on the nodes that stay."""
        leaving, self._done = self._done[:count], self._done[count:]
        return [e.remainder for e in self._outstanding(leaving, {e.node for e in leaving})]

    def separator(self) -> set[int]:
        """Return the nodes that are not eliminated but are parents of eliminated ones.

        They must not be linearised at another point.
        """
        done = {e.node for e in self._done}
        return set().union(*(e.parents for e in self._outstanding(self._done, done))) - done

    @staticmethod
    def _outstanding(done: Sequence[Eliminated], gone: set[int]) -> list[Eliminated]:
        """Return those whose remainder was not part of a later elimination."""
        return [e for e in done if e.parents and gone.isdisjoint(e.parents)]

    def eliminate(self, nodes: Sequence[int], factors: Iterable[gtsam.GaussianFactor]) -> None:
        """Eliminate the nodes that are not eliminated yet.

        Args:
            nodes: All nodes, oldest first.
            factors: The linear factors whose oldest node is not eliminated yet.

        Raises:
            RuntimeError: By GTSAM, if a node is not determined.
        """
        first = len(self._done)
        ranks = {node: i for i, node in enumerate(nodes[first:])}
        buckets = [gtsam.GaussianFactorGraph() for _ in ranks]
        for factor in factors:
            buckets[_oldest(ranks, nodes_of(factor))].push_back(factor)
        for e in self._outstanding(self._done, set(nodes[:first])):
            buckets[_oldest(ranks, e.parents)].push_back(e.remainder)
        for node, bucket in zip(nodes[first:], buckets, strict=True):
            conditional, remainder = gtsam.EliminateQR(bucket, self._ordering(node))
            parents = nodes_of(remainder)
            self._done.append(Eliminated(node, conditional, remainder, parents))
            if parents:
                buckets[_oldest(ranks, parents)].push_back(remainder)

    def _ordering(self, node: int) -> gtsam.Ordering:
        ordering = gtsam.Ordering()
        for key in keys(node):
            ordering.push_back(key)
        if self._has_clock:
            ordering.push_back(clock_key(node))
        return ordering

    def newest(self) -> gtsam.GaussianConditional:
        """Return the newest node's conditional, which has no parents."""
        return self._done[-1].conditional

    def backwards(self) -> Iterable[Eliminated]:
        """Yield the nodes from the newest to the oldest."""
        return reversed(self._done)


def _oldest(ranks: Mapping[int, int], nodes: frozenset[int]) -> int:
    return min(ranks[node] for node in nodes)
