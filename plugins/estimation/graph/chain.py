"""Triangulation of a chain of nodes by QR, from the oldest on, that remembers what nothing new has
touched.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import gtsam
from executive_plugins.estimation.graph.factors import keys

_INDEX = (1 << 56) - 1  # a key's last 56 bits number its node; the first 8 are the letter


def node_of(key: int) -> int:
    """Return the node that a key belongs to."""
    return key & _INDEX


def nodes_of(factor: gtsam.NonlinearFactor | gtsam.GaussianFactor) -> frozenset[int]:
    """Return the nodes that a factor touches."""
    return frozenset(key & _INDEX for key in factor.keys())  # noqa: SIM118 - GTSAM's, no mapping's


@dataclass(frozen=True, slots=True, eq=False)
class Eliminated:
    """A node that is expressed by later ones.

    Attributes:
        node: The node.
        conditional: The node given those that it is tied to.
        rest: What the node's factors say of later nodes.
        heirs: The nodes that the rest touches; none after the last.
    """

    node: int
    conditional: gtsam.GaussianConditional
    rest: gtsam.JacobianFactor
    heirs: frozenset[int]


class GraphChain:
    """The nodes eliminated so far, oldest first.

    Measurements fall on the newest few of sixty nodes, and what was eliminated before them stays as
    it was: an update costs what is new, not what is in the window. The idea is iSAM2's (Kaess
    2012), whose tree is a chain here, so that a list will do; unlike there a node may be put in
    anywhere.
    """

    def __init__(self) -> None:
        self._done: list[Eliminated] = []

    def __len__(self) -> int:
        return len(self._done)

    def copy(self) -> "GraphChain":
        """Return an independent chain of the same content."""
        twin = GraphChain()
        twin._done = self._done.copy()
        return twin

    def void_from(self, rank: int) -> None:
        """Forget the elimination of a node and of all that are newer."""
        del self._done[max(rank, 0) :]

    def drop(self, count: int) -> list[gtsam.JacobianFactor]:
        """Forget the oldest nodes; return what they say of those that stay (their marginal)."""
        leaving, self._done = self._done[:count], self._done[count:]
        return [e.rest for e in self._inherited(leaving, {e.node for e in leaving})]

    def separator(self) -> set[int]:
        """Return the nodes that are not eliminated, but touched by what is: they may not be
        linearised anew.
        """
        done = {e.node for e in self._done}
        return set().union(*(e.heirs for e in self._inherited(self._done, done))) - done

    @staticmethod
    def _inherited(done: Sequence[Eliminated], gone: set[int]) -> list[Eliminated]:
        """Return those whose rest has not been eliminated in its turn."""
        return [e for e in done if e.heirs and gone.isdisjoint(e.heirs)]

    def eliminate(self, nodes: Sequence[int], factors: Iterable[gtsam.GaussianFactor]) -> None:
        """Eliminate the nodes that are not yet.

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
        for e in self._inherited(self._done, set(nodes[:first])):
            buckets[_oldest(ranks, e.heirs)].push_back(e.rest)
        for node, bucket in zip(nodes[first:], buckets, strict=True):
            conditional, rest = gtsam.EliminateQR(bucket, _ordering(node))
            heirs = nodes_of(rest)
            self._done.append(Eliminated(node, conditional, rest, heirs))
            if heirs:
                buckets[_oldest(ranks, heirs)].push_back(rest)

    def newest(self) -> gtsam.GaussianConditional:
        """Return the newest node's conditional, which depends on no other."""
        return self._done[-1].conditional

    def backwards(self) -> Iterable[Eliminated]:
        """Yield the nodes from the newest to the oldest."""
        return reversed(self._done)


def _oldest(ranks: Mapping[int, int], nodes: frozenset[int]) -> int:
    return min(ranks[node] for node in nodes)


def _ordering(node: int) -> gtsam.Ordering:
    ordering = gtsam.Ordering()
    for key in keys(node):
        ordering.push_back(key)
    return ordering
