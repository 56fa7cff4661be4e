"""A fixed-lag factor graph: nodes at measurements, inertial factors, a prior for older nodes."""

from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import dataclass

import gtsam
import numpy as np
from executive_plugins.estimation.factors import (
    clock_factor,
    clock_key,
    covariance_of,
    fix_factor,
    inertial_factor,
    late_fix_factor,
    prior,
)
from executive_plugins.estimation.gate.measurements import Fix
from executive_plugins.estimation.graph.chain import GraphChain, nodes_of
from executive_plugins.estimation.graph.node_values import NodeValues
from executive_plugins.estimation.inertial.clock_offset import ClockOffset
from executive_plugins.estimation.inertial.noise import InertialNoise
from executive_plugins.estimation.inertial.sample_buffer import SampleBuffer
from executive_plugins.estimation.inertial.state import (
    DIMENSION,
    InertialState,
    propagate_through,
)
from executive_plugins.estimation.inertial.steady_rate import SteadyRate

from executive.arrays import Float
from executive.errors import DataError

_SAME_S = 5e-4  # measurements nearer in time share a node: at 1 m/s that is half a millimetre
_MOST_ITERATIONS = 6
# Largest distance of a node from the linearisation point of its factors, in GTSAM's order of a
# step: biases of accelerometer and gyro, velocity, rotation, position, and the receiver's clock if
# that is unknown. The neglected terms are of second order, besides a change in the weight of robust
# kernels.
_LINEAR = np.append(np.repeat([0.02, 2e-3, 0.03, 6e-4, 1.5e-3], 3), 5e-3)
# Changes of a node below these values, in the order of _LINEAR, are not propagated to older nodes,
# whose states are not reported.
_UNMOVED = np.append(np.repeat([5e-4, 2e-5, 2e-4, 5e-5, 2e-4], 3), 2e-5)
_KNOWN = ClockOffset()


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

    A receiver's clock that is unknown is a state of each node: a stamp that is late by d moves a
    fix by the velocity times d, which a graph that knows nothing of it takes for position.

    Attributes:
        covariance: Of the newest state's error, shape (15, 15).
        clock: The receiver's clock at the newest node.
    """

    def __init__(
        self,
        noise: InertialNoise,
        samples: SampleBuffer,
        first: InertialState,
        covariance: Float,
        clock: ClockOffset = _KNOWN,
    ) -> None:
        """Begin at a state.

        Args:
            noise: Noise of the inertial sensor.
            samples: Its samples, from that of the first state on.
            first: The first state.
            covariance: Of its error, shape (15, 15).
            clock: The receiver's clock, and what it shares with that error.
        """
        self._noise = noise
        self._samples = samples
        self._stamps_s = [first.stamp_s]
        self._nodes = [0]
        self._next_node = 1
        self._has_clock = not clock.is_known
        self._values = NodeValues(self._has_clock)
        self._values.insert(0, first, clock.offset_s)
        self._chain = GraphChain(self._has_clock)
        known = prior(0, first, covariance, clock if self._has_clock else None)
        self._prior = [_Measured("prior", -np.inf, f, nodes_of(f)) for f in known]
        self._between: dict[int, list[gtsam.NonlinearFactor]] = {}  # by the node at the end
        self._measured: list[_Measured] = []
        self.covariance, self.clock = covariance, clock

    def copy(self) -> "GraphWindow":
        """Return an independent window with the same content; factors are immutable and shared."""
        twin = object.__new__(GraphWindow)
        twin.__dict__.update(self.__dict__)
        twin._values, twin._chain = self._values.copy(), self._chain.copy()
        twin._stamps_s, twin._nodes = self._stamps_s.copy(), self._nodes.copy()
        twin._between, twin._measured, twin._prior = (
            self._between.copy(),
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
        return self._values.state(self._nodes[i], self._samples.at(self._stamps_s[i]))

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
        self._values.insert(node, self.state_at(stamp_s), self._values.late_s(self._nodes[i - 1]))
        self._stamps_s.insert(i, stamp_s)
        self._nodes.insert(i, node)
        for j in (i, i + 1):
            if j < len(self._nodes):
                self._between[self._nodes[j]] = self._factors_between(j)
        self._chain.void_from(i - 1)
        return node

    def factor_of(self, fix: Fix) -> gtsam.NonlinearFactor:
        """Return a factor of a fix, on the node at its time, which is created if there is none."""
        node = self.node_at(fix.stamp_s)
        if not self._has_clock:
            return fix_factor(node, fix)
        state = self._state(self._nodes.index(node))
        steady = SteadyRate(self._samples, self._noise, state.stamp_s)
        return late_fix_factor(node, clock_key(node), fix, steady.speed(state, fix.arm_imu))

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

    def _factors_between(self, i: int) -> list[gtsam.NonlinearFactor]:
        """Return the factors between a node and the one before it: of the samples, of the clock."""
        begin_s, end_s = self._stamps_s[i - 1 : i + 1]
        nodes, samples = (self._nodes[i - 1], self._nodes[i]), self._samples.between(begin_s, end_s)
        found = [inertial_factor(nodes, self._state(i - 1), samples, self._noise)]
        return [*found, clock_factor(nodes, end_s - begin_s)] if self._has_clock else found

    def solve(self) -> None:
        """Compute the most probable values (Gauss-Newton) and the covariance of the newest node.

        Raises:
            UnsolvableError: If the equations have no unique solution or it is not finite.
        """
        for _ in range(_MOST_ITERATIONS):
            moved = self._iterate()
            steps = {node: self._values.steps[node].vector() for node in moved}
            far = {node for node, step in steps.items() if _exceeds(step, _LINEAR)}
            if not far:
                return
            self._void(m for m in self._factors() if not far.isdisjoint(m.nodes))

    def _factors(self, rank: int = 0) -> list[_Measured]:
        """Return all factors whose oldest node has a rank or a newer one."""
        wanted = frozenset(self._nodes[rank:])
        pairs = zip(self._nodes[rank:], self._nodes[rank + 1 :], strict=False)
        between = [
            _Measured("between", 0.0, factor, frozenset((node, after)))
            for node, after in pairs
            for factor in self._between[after]
        ]
        return [*between, *(m for m in (*self._prior, *self._measured) if m.nodes <= wanted)]

    def _iterate(self) -> set[int]:
        """Linearise, eliminate and solve what is new; return the nodes that have moved."""
        first = len(self._chain)
        if first == len(self._nodes):
            return set()
        self._values.move_points(set(self._nodes[first:]) - self._chain.separator())
        graph = gtsam.NonlinearFactorGraph()
        for measured in self._factors(first):
            graph.push_back(measured.factor)
        try:
            linear = graph.linearize(self._values.points)
            self._chain.eliminate(self._nodes, (linear.at(k) for k in range(linear.size())))
            moved = self._substitute(set(self._nodes[first:]))
        except RuntimeError as error:  # GTSAM raises it on a singular system
            raise UnsolvableError(str(error).strip().splitlines()[0]) from error
        newest = self._nodes[-1]
        P = covariance_of(self._chain.newest().R(), self.newest().R_map_imu)
        if not (np.isfinite(self._values.steps[newest].vector()).all() and np.isfinite(P).all()):
            raise UnsolvableError("the solution is not finite")
        self.covariance = P[:DIMENSION, :DIMENSION]
        if self._has_clock:
            late_s, std_s = self._values.late_s(newest), float(np.sqrt(P[-1, -1]))
            self.clock = ClockOffset(late_s, std_s, P[:DIMENSION, -1])
        return moved

    def _substitute(self, fresh: set[int]) -> set[int]:
        """Solve from the newest node back, as long as values change; return the changed nodes."""
        moved, steps = set[int](), self._values.steps
        for done in self._chain.backwards():
            if done.node not in fresh and moved.isdisjoint(done.parents):
                continue
            later = gtsam.VectorValues()
            for parent in done.parents:
                later.insert(steps[parent])
            step = done.conditional.solve(later)
            if done.node in fresh or _exceeds(step.vector() - steps[done.node].vector(), _UNMOVED):
                moved.add(done.node)
                steps[done.node] = step
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
            del self._between[after]
        self._values.erase(leaving)
        del self._nodes[:count], self._stamps_s[:count]

    def _prior_of(self, remainder: gtsam.JacobianFactor) -> _Measured:
        factor = gtsam.LinearContainerFactor(remainder, self._values.points_of(remainder.keys()))
        return _Measured("prior", -np.inf, factor, nodes_of(factor))


def _exceeds(change: Float, bounds: Float) -> bool:
    return bool((np.abs(change) > bounds[: len(change)]).any())
