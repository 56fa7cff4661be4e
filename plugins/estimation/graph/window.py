"""One factor graph over the last seconds: nodes at measurements, inertial factors between, what is
older as a prior.
"""

from bisect import bisect_left
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import gtsam
import numpy as np
from executive_plugins.estimation.graph.chain import GraphChain, nodes_of
from executive_plugins.estimation.graph.factors import (
    covariance_of,
    extract,
    inertial_factor,
    insert,
    keys,
    prior,
)
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import InertialState, propagate_through

from executive.arrays import Float
from executive.errors import DataError

_SAME_S = 5e-4  # measurements nearer in time share a node: at 1 m/s that is half a millimetre
_MOST_ITERATIONS = 6
# How far a node may be from where its factors are linearised, in GTSAM's order of a step: biases of
# the accelerometer and the gyro, velocity, rotation, position. What that neglects is of second
# order, and a share of a kernel's weight.
_LINEAR = np.repeat([0.02, 2e-3, 0.03, 6e-4, 1.5e-3], 3)
# Changes of a node that are not handed on to older ones, in the order of _LINEAR: none of those is
# given out.
_UNMOVED = np.repeat([5e-4, 2e-5, 2e-4, 5e-5, 2e-4], 3)


class UnsolvableError(DataError):
    """The window's equations have no unique solution: build it anew."""


@dataclass(frozen=True, slots=True, eq=False)
class _Measured:
    """A factor that can be taken back by its kind and time [s], and the nodes that it touches."""

    kind: str
    stamp_s: float
    factor: gtsam.NonlinearFactor
    nodes: frozenset[int]


class GraphWindow:
    """A fixed-lag smoother that is solved whole, by QR along the chain of its nodes.

    The paper makes a node of every inertial sample (Nubert 2022, Sec. IV-A2); here nodes stand
    where something was measured, and the sample that a node falls into is split there: the same
    estimate from a quarter of the states. Only what a measurement touches is eliminated and
    linearised again, yet a node may be put in anywhere, and the newest covariance is the last
    triangle. Cholesky is no option: its squared condition throws on tight inertial noise.
    """

    def __init__(
        self, noise: InertialNoise, samples: SampleBuffer, first: InertialState, covariance: Float
    ) -> None:
        self._noise = noise
        self._samples = samples
        self._stamps_s = [first.stamp_s]
        self._nodes = [0]
        self._next_node = 1
        self._points = gtsam.Values()  # where the factors are linearised, close to the estimate
        insert(self._points, 0, first)
        self._chain = GraphChain()
        self._steps: dict[int, gtsam.VectorValues] = {}  # from the points to the estimate, by node
        self._prior = [
            _Measured("prior", -np.inf, f, nodes_of(f)) for f in prior(0, first, covariance)
        ]
        self._inertial: dict[int, gtsam.NonlinearFactor] = {}  # by the node at the end
        self._measured: list[_Measured] = []
        self.covariance = covariance

    def copy(self) -> "GraphWindow":
        """Return an independent window of the same content; factors are shared, for they never
        change.
        """
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
        """Return the state at a time within the samples, carried on from the node before it."""
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
        """Return the node at a time within the window and the samples,
        making it if there is none.
        """
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
        """Add factors between nodes; kind and time are what they can be taken back by."""
        added = [_Measured(kind, stamp_s, factor, nodes_of(factor)) for factor in factors]
        self._measured.extend(added)
        self._void(added)

    def take_back(self, kind: str, after_s: float) -> None:
        """Remove the factors of a kind that are newer than a time and still in the window."""
        wrong = [m for m in self._measured if m.kind == kind and m.stamp_s > after_s]
        self._measured = [m for m in self._measured if m.kind != kind or m.stamp_s <= after_s]
        self._void(wrong)

    def _void(self, changed: Iterable[_Measured]) -> None:
        """Forget the elimination of all that these factors touch."""
        touched = frozenset().union(*(m.nodes for m in changed))
        rank = next((i for i, node in enumerate(self._nodes) if node in touched), len(self._nodes))
        self._chain.void_from(rank)

    def _inertial_factor(self, i: int) -> gtsam.NonlinearFactor:
        """Tie a node to the one before it."""
        samples = self._samples.between(self._stamps_s[i - 1], self._stamps_s[i])
        return inertial_factor(
            (self._nodes[i - 1], self._nodes[i]), self._state(i - 1), samples, self._noise
        )

    def solve(self) -> None:
        """Bring all nodes to the most probable values (Gauss–Newton), and the newest's covariance
        with them.

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
        """Return all factors whose oldest node is of a rank or newer."""
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
        except RuntimeError as error:  # what GTSAM throws on a singular system
            raise UnsolvableError(str(error).strip().splitlines()[0]) from error
        newest = self._nodes[-1]
        self.covariance = covariance_of(self._chain.newest().R(), self.newest().R_map_imu)
        if not (
            np.isfinite(self._steps[newest].vector()).all() and np.isfinite(self.covariance).all()
        ):
            raise UnsolvableError("the solution is not finite")
        return moved

    def _move_points(self, nodes: Iterable[int]) -> None:
        """Linearise nodes at the estimate from now on."""
        steps = gtsam.VectorValues()
        for node in nodes:
            if node in self._steps:
                steps.insert(self._steps.pop(node))
        self._points = self._points.retract(steps)

    def _substitute(self, fresh: set[int]) -> set[int]:
        """Solve from the newest node back, as far as anything moves; return what does."""
        moved: set[int] = set()
        for done in self._chain.backwards():
            if done.node not in fresh and moved.isdisjoint(done.heirs):
                continue
            later = gtsam.VectorValues()
            for heir in done.heirs:
                later.insert(self._steps[heir])
            step = done.conditional.solve(later)
            if done.node in fresh or _differs(self._steps[done.node], step):
                moved.add(done.node)
                self._steps[done.node] = step
        return moved

    def forget_before(self, stamp_s: float) -> None:
        """Turn the nodes older than a time into a prior on those that they are tied to
        (marginalisation).
        """
        count = min(bisect_left(self._stamps_s, stamp_s), len(self._nodes) - 1)
        if count <= 0:
            return
        if len(self._chain) < count:
            self._iterate()
        leaving = self._nodes[:count]
        rests = self._chain.drop(count)
        stayed = [p for p in self._prior if p.nodes.isdisjoint(leaving)]
        self._prior = [*stayed, *(self._prior_of(rest) for rest in rests)]
        self._measured = [m for m in self._measured if m.nodes.isdisjoint(leaving)]
        for after in self._nodes[1 : count + 1]:
            del self._inertial[after]
        for node in leaving:
            del self._steps[node]
            for key in keys(node):
                self._points.erase(key)
        del self._nodes[:count], self._stamps_s[:count]

    def _prior_of(self, rest: gtsam.JacobianFactor) -> _Measured:
        factor = gtsam.LinearContainerFactor(rest, self._points_of(rest.keys()))
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
