"""A fixed-lag factor graph: nodes at measurements, inertial factors, a prior for older nodes."""

from bisect import bisect_left
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import gtsam
import numpy as np
from executive_plugins.estimation.factors import (
    covariance_of,
    extract,
    inertial_factor,
    insert,
    keys,
    prior,
)
from executive_plugins.estimation.graph.chain import GraphChain, nodes_of
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import InertialState, propagate_through

from executive.arrays import Float
from executive.errors import DataError

_SAME_S = 5e-4  # measurements nearer in time share a node: at 1 m/s that is half a millimetre
_MOST_ITERATIONS = 6
# Largest distance of a node from the linearisation point of its factors, in GTSAM's order of a
# step: biases of accelerometer and gyro, velocity, rotation, position. The neglected terms are of
# second order, besides a change in the weight of robust kernels.
_LINEAR = np.repeat([0.02, 2e-3, 0.03, 6e-4, 1.5e-3], 3)
# Changes of a node below these values, in the order of _LINEAR, are not propagated to older nodes,
# whose states are not reported.
_UNMOVED = np.repeat([5e-4, 2e-5, 2e-4, 5e-5, 2e-4], 3)


class UnsolvableError(DataError):
    """The window's equations have no unique solution, so that it must be built again."""


@dataclass(frozen=True, slots=True, eq=False)
class _Measured:
    """A factor that can be removed by its kind and time [s], and the nodes that it touches."""

    kind: str
    stamp_s: float
    factor: gtsam.NonlinearFactor
    nodes: frozenset[int]


class GraphWindow:
    """A fixed-lag smoother that is solved by QR along the chain of its nodes.

    The paper makes a node of every inertial sample (Nubert 2022, Sec. IV-A2). Here there is a node
    at each measurement, and the sample that contains it is split there: the same estimate from a
    quarter of the states. Only nodes that a measurement touches are eliminated and linearised
    again, yet a node may be inserted anywhere. The newest covariance follows from the last triangle
    of the elimination. Cholesky is not suitable: with tight inertial noise, the squared condition
    number makes it fail.
    """

    def __init__(
        self, noise: InertialNoise, samples: SampleBuffer, first: InertialState, covariance: Float
    ) -> None:
        self._noise = noise
        self._samples = samples
        self._stamps_s = [first.stamp_s]
        self._nodes = [0]
        self._next_node = 1
        self._points = gtsam.Values()  # linearisation points, close to the estimate
        insert(self._points, 0, first)
        self._chain = GraphChain()
        self._steps: dict[
            int, gtsam.VectorValues
        ] = {}  # from linearisation point to estimate, by node
        self._prior = [
            _Measured("prior", -np.inf, f, nodes_of(f)) for f in prior(0, first, covariance)
        ]
        self._inertial: dict[int, gtsam.NonlinearFactor] = {}  # by the node at the end
        self._measured: list[_Measured] = []
        self.covariance = covariance

    def copy(self) -> "GraphWindow":
        """Return an independent window with the same content; factors are immutable and shared."""
        twin = object.__new__(GraphWindow)
        twin.__dict__.update(self.__dict__)
        twin._points, twin._steps = gtsam.Values(self._points), self._steps.copy()
        twin._chain = self._chain.copy()
        twin._stamps_s, twin._nodes = self._stamps_s.copy(), self._nodes.copy()
        twin._inertial, twin._measured, twin._prior = (
            self._inertial.copy(),
            self._measured.copy(),
            self._prior.copy(),
        )
        return twin

    @property
    def oldest_s(self) -> float:
        """Time of the oldest node [s]."""
        return self._stamps_s[0]

    @property
    def newest_s(self) -> float:
        """Time of the newest node [s]."""
        return self._stamps_s[-1]

    def __len__(self) -> int:
        return len(self._nodes)

    def newest(self) -> InertialState:
        """Return the state of the newest node."""
        return self._state(len(self._nodes) - 1)

    def state_at(self, stamp_s: float) -> InertialState:
        """Return the state at a time within the samples, propagated from the node before it."""
        i = max(bisect_left(self._stamps_s, stamp_s + _SAME_S) - 1, 0)
        state = self._state(i)
        return propagate_through(
            state, self._samples.between(state.stamp_s, stamp_s), self._noise.gravity_m_s2
        )

    def _state(self, i: int) -> InertialState:
        node = self._nodes[i]
        return extract(
            self._points, node, self._samples.at(self._stamps_s[i]), self._steps.get(node)
        )

    def node_at(self, stamp_s: float) -> int:
        """Return the node at a time within window and samples; create it if there is none."""
        i = bisect_left(self._stamps_s, stamp_s - _SAME_S)
        if i < len(self._stamps_s) and self._stamps_s[i] - stamp_s <= _SAME_S:
            return self._nodes[i]
        if i == 0:
            raise DataError(
                f"a node at {stamp_s} s is older than the window, which begins at {self.oldest_s} s"
            )
        node = self._next_node
        self._next_node += 1
        insert(self._points, node, self.state_at(stamp_s))
        self._stamps_s.insert(i, stamp_s)
        self._nodes.insert(i, node)
        for j in (i, i + 1):
            if j < len(self._nodes):
                self._inertial[self._nodes[j]] = self._inertial_factor(j)
        self._chain.void_from(i - 1)
        return node

    def add(self, kind: str, stamp_s: float, factors: Iterable[gtsam.NonlinearFactor]) -> None:
        """Add factors between nodes; `take_back` removes them by kind and time."""
        added = [_Measured(kind, stamp_s, factor, nodes_of(factor)) for factor in factors]
        self._measured.extend(added)
        self._void(added)

    def take_back(self, kind: str, after_s: float) -> None:
        """Remove the factors of a kind that are newer than a time and still in the window."""
        wrong = [m for m in self._measured if m.kind == kind and m.stamp_s > after_s]
        self._measured = [m for m in self._measured if m.kind != kind or m.stamp_s <= after_s]
        self._void(wrong)

    def _void(self, changed: Iterable[_Measured]) -> None:
        """Undo the elimination of all nodes from the oldest that these factors touch."""
        touched = frozenset().union(*(m.nodes for m in changed))
        rank = next((i for i, node in enumerate(self._nodes) if node in touched), len(self._nodes))
        self._chain.void_from(rank)

    def _inertial_factor(self, i: int) -> gtsam.NonlinearFactor:
        """Return the inertial factor between a node and the one before it."""
        samples = self._samples.between(self._stamps_s[i - 1], self._stamps_s[i])
        return inertial_factor(
            (self._nodes[i - 1], self._nodes[i]), self._state(i - 1), samples, self._noise
        )

    def solve(self) -> None:
        """Compute the most probable values (Gauss-Newton) and the covariance of the newest node.

        Raises:
            UnsolvableError: If the equations have no unique solution or it is not finite.
        """
        for _ in range(_MOST_ITERATIONS):
            moved = self._iterate()
            far = {node for node in moved if (np.abs(self._steps[node].vector()) > _LINEAR).any()}
            if not far:
                return
            self._void(m for m in self._factors() if not far.isdisjoint(m.nodes))

    def _factors(self, rank: int = 0) -> list[_Measured]:
        """Return all factors whose oldest node has a rank or a newer one."""
        wanted = frozenset(self._nodes[rank:])
        pairs = zip(self._nodes[rank:], self._nodes[rank + 1 :], strict=False)
        inertial = [
            _Measured("imu", 0.0, self._inertial[after], frozenset((node, after)))
            for node, after in pairs
        ]
        return [*inertial, *(m for m in (*self._prior, *self._measured) if m.nodes <= wanted)]

    def _iterate(self) -> set[int]:
        """Linearise, eliminate and solve what is new; return the nodes that have moved."""
        first = len(self._chain)
        if first == len(self._nodes):
            return set()
        self._move_points(set(self._nodes[first:]) - self._chain.separator())
        graph = gtsam.NonlinearFactorGraph()
        for measured in self._factors(first):
            graph.push_back(measured.factor)
        try:
            linear = graph.linearize(self._points)
            self._chain.eliminate(self._nodes, (linear.at(k) for k in range(linear.size())))
            moved = self._substitute(set(self._nodes[first:]))
        except RuntimeError as error:  # GTSAM raises it on a singular system
            raise UnsolvableError(str(error).strip().splitlines()[0]) from error
        newest = self._nodes[-1]
        self.covariance = covariance_of(self._chain.newest().R(), self.newest().R_map_imu)
        if not (
            np.isfinite(self._steps[newest].vector()).all() and np.isfinite(self.covariance).all()
        ):
            raise UnsolvableError("the solution is not finite")
        return moved

    def _move_points(self, nodes: Iterable[int]) -> None:
        """Move the linearisation points of nodes to the estimate."""
        steps = gtsam.VectorValues()
        for node in nodes:
            if node in self._steps:
                steps.insert(self._steps.pop(node))
        self._points = self._points.retract(steps)

    def _substitute(self, fresh: set[int]) -> set[int]:
        """Solve from the newest node back, as long as values change; return the changed nodes."""
        moved: set[int] = set()
        for done in self._chain.backwards():
            if done.node not in fresh and moved.isdisjoint(done.parents):
                continue
            later = gtsam.VectorValues()
            for parent in done.parents:
                later.insert(self._steps[parent])
            step = done.conditional.solve(later)
            if done.node in fresh or _differs(self._steps[done.node], step):
                moved.add(done.node)
                self._steps[done.node] = step
        return moved

    def forget_before(self, stamp_s: float) -> None:
        """Marginalise the nodes older than a time: they become a prior on their neighbours."""
        count = min(bisect_left(self._stamps_s, stamp_s), len(self._nodes) - 1)
        if count <= 0:
            return
        if len(self._chain) < count:
            self._iterate()
        leaving = self._nodes[:count]
        remainders = self._chain.drop(count)
        stayed = [p for p in self._prior if p.nodes.isdisjoint(leaving)]
        self._prior = [*stayed, *map(self._prior_of, remainders)]
        self._measured = [m for m in self._measured if m.nodes.isdisjoint(leaving)]
        for after in self._nodes[1 : count + 1]:
            del self._inertial[after]
        for node in leaving:
            del self._steps[node]
            for key in keys(node):
                self._points.erase(key)
        del self._nodes[:count], self._stamps_s[:count]

    def _prior_of(self, remainder: gtsam.JacobianFactor) -> _Measured:
        factor = gtsam.LinearContainerFactor(remainder, self._points_of(remainder.keys()))
        return _Measured("prior", -np.inf, factor, nodes_of(factor))

    def _points_of(self, wanted: Sequence[int]) -> gtsam.Values:
        values = gtsam.Values()
        for key in wanted:
            kind = chr(gtsam.Symbol(key).chr())
            if kind == "x":
                values.insert(key, self._points.atPose3(key))
            elif kind == "v":
                values.insert(key, self._points.atVector(key))
            else:
                values.insert(key, self._points.atConstantBias(key))
        return values


def _differs(before: gtsam.VectorValues, after: gtsam.VectorValues) -> bool:
    return bool((np.abs(after.vector() - before.vector()) > _UNMOVED).any())
