"""One factor graph over the last seconds: nodes at measurements, inertial factors between, what is older as a prior."""

from bisect import bisect_left
from collections.abc import Iterable

import gtsam
import numpy as np

from executive.arrays import Float
from executive.errors import DataError
from plugins.estimation.graph_factors import (
    bias_of,
    covariance_of,
    extract,
    insert,
    keys,
    preintegration,
    prior,
)
from plugins.estimation.inertial_noise import InertialNoise
from plugins.estimation.inertial_state import InertialState, propagate, skew
from plugins.estimation.sample_buffer import LONG_GAP_S, SampleBuffer

_SAME_S = 5e-4  # measurements nearer in time share a node: at 1 m/s that is half a millimetre
_SMALL_STEP = 5e-3  # a change of pose [rad, m] below which one iteration of Gauss–Newton is enough
_MOST_ITERATIONS = 6


class UnsolvableError(DataError):
    """The window's equations have no unique solution: build it anew."""


class GraphWindow:
    """A fixed-lag smoother that is solved whole, by QR along the chain of its nodes.

    The paper makes a node of every inertial sample (Nubert 2022, Sec. IV-A2); here nodes stand where something was
    measured, and the sample that a node falls into is split there: the same estimate from a quarter of the states.
    Solving the whole window costs 3 ms at 60 nodes, as much as an incremental smoother whose nodes never come late;
    in return a node may be put in anywhere, and the newest covariance is the last triangle. Cholesky is no option: its
    squared condition throws on tight inertial noise.
    """

    def __init__(self, noise: InertialNoise, samples: SampleBuffer, first: InertialState, covariance: Float) -> None:
        self._noise = noise
        self._params = preintegration(noise)
        self._samples = samples
        self._stamps_s = [first.stamp_s]
        self._nodes = [0]
        self._next_node = 1
        self._values = gtsam.Values()
        insert(self._values, 0, first)
        self._prior = prior(0, first, covariance)
        self._inertial: dict[int, gtsam.NonlinearFactor] = {}  # by the node at the end
        self._measured: list[tuple[str, float, gtsam.NonlinearFactor]] = []
        self.covariance = covariance

    def copy(self) -> "GraphWindow":
        """Return an independent window of the same content; factors are shared, for they never change."""
        twin = object.__new__(GraphWindow)
        twin.__dict__.update(self.__dict__)
        twin._values = gtsam.Values(self._values)
        twin._stamps_s, twin._nodes = self._stamps_s.copy(), self._nodes.copy()
        twin._inertial, twin._measured, twin._prior = self._inertial.copy(), self._measured.copy(), self._prior.copy()
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
        for sample in self._samples.between(state.stamp_s, stamp_s):
            state = propagate(state, sample, self._noise.gravity_m_s2)
        return state

    def _state(self, i: int) -> InertialState:
        return extract(self._values, self._nodes[i], self._samples.at(self._stamps_s[i]))

    def node_at(self, stamp_s: float) -> int:
        """Return the node at a time within the window and the samples, making it if there is none."""
        i = bisect_left(self._stamps_s, stamp_s - _SAME_S)
        if i < len(self._stamps_s) and self._stamps_s[i] - stamp_s <= _SAME_S:
            return self._nodes[i]
        if i == 0:
            raise DataError(f"a node at {stamp_s} s is older than the window, which begins at {self.oldest_s} s")
        node = self._next_node
        self._next_node += 1
        insert(self._values, node, self.state_at(stamp_s))
        self._stamps_s.insert(i, stamp_s)
        self._nodes.insert(i, node)
        for j in (i, i + 1):
            if j < len(self._nodes):
                self._inertial[self._nodes[j]] = self._inertial_factor(j)
        return node

    def add(self, kind: str, stamp_s: float, factors: Iterable[gtsam.NonlinearFactor]) -> None:
        """Add factors between nodes; kind and time are what they can be taken back by."""
        self._measured.extend((kind, stamp_s, factor) for factor in factors)

    def take_back(self, kind: str, after_s: float) -> None:
        """Remove the factors of a kind that are newer than a time and still in the window."""
        self._measured = [m for m in self._measured if m[0] != kind or m[1] <= after_s]

    def _inertial_factor(self, i: int) -> gtsam.NonlinearFactor:
        """Preintegrate from the node before; forces act in the attitude of a sample's middle, as in `propagate`."""
        begin_s, end_s = self._stamps_s[i - 1], self._stamps_s[i]
        first = self._state(i - 1)
        samples = self._samples.between(begin_s, end_s)
        gap_s = max((s.since_last_s for s in samples), default=0.0)
        params = self._params if gap_s <= LONG_GAP_S else preintegration(self._noise, gap_s)
        sums = gtsam.PreintegratedCombinedMeasurements(params, bias_of(first))
        for sample in samples:
            dt_s = sample.stamp_s - begin_s
            rate = sample.rate - first.gyro_bias
            half_turned = sample.force + 0.5 * dt_s * (skew(rate) @ (sample.force - first.accel_bias))
            sums.integrateMeasurement(half_turned, sample.rate, dt_s)
            begin_s = sample.stamp_s
        (x0, v0, b0), (x1, v1, b1) = keys(self._nodes[i - 1]), keys(self._nodes[i])
        return gtsam.CombinedImuFactor(x0, v0, x1, v1, b0, b1, sums)

    def solve(self) -> None:
        """Bring all nodes to the most probable values (Gauss–Newton), and the newest's covariance with them.

        Raises:
            UnsolvableError: If the equations have no unique solution or it is not finite.
        """
        for _ in range(_MOST_ITERATIONS):
            if self._iterate() < _SMALL_STEP:
                return

    def _iterate(self) -> float:
        """Take one step; return how far it moves the newest pose [rad, m]."""
        graph = gtsam.NonlinearFactorGraph()
        for factor in (*self._prior, *self._inertial.values(), *(m[2] for m in self._measured)):
            graph.push_back(factor)
        try:
            conditionals = self._eliminate(graph.linearize(self._values))
            step = gtsam.VectorValues()
            for conditional in reversed(conditionals):
                step.insert(conditional.solve(step))
            self._values = self._values.retract(step)
        except RuntimeError as error:  # what GTSAM throws on a singular system
            raise UnsolvableError(str(error).strip().splitlines()[0]) from error
        newest = self._nodes[-1]
        self.covariance = covariance_of(conditionals[-1].R(), self._values.atPose3(keys(newest)[0]).rotation().matrix())
        length = float(np.abs(step.at(keys(newest)[0])).max())
        if not (np.isfinite(length) and np.isfinite(self.covariance).all()):
            raise UnsolvableError("the solution is not finite")
        return length

    def _eliminate(self, linear: gtsam.GaussianFactorGraph) -> list[gtsam.GaussianConditional]:
        """Triangulate node by node, from the oldest: what is left of one goes to the next that it touches."""
        ranks = {key: i for i, node in enumerate(self._nodes) for key in keys(node)}
        buckets = [gtsam.GaussianFactorGraph() for _ in self._nodes]
        for k in range(linear.size()):
            factor = linear.at(k)
            touched = factor.keys()
            buckets[min(ranks[key] for key in touched)].push_back(factor)
        conditionals = []
        for bucket, node in zip(buckets, self._nodes, strict=True):
            conditional, rest = gtsam.EliminateQR(bucket, _ordering([node]))
            conditionals.append(conditional)
            touched = rest.keys()
            if touched:
                buckets[min(ranks[key] for key in touched)].push_back(rest)
        return conditionals

    def forget_before(self, stamp_s: float) -> None:
        """Turn the nodes older than a time into a prior on those that they are tied to (marginalisation)."""
        count = min(bisect_left(self._stamps_s, stamp_s), len(self._nodes) - 1)
        if count <= 0:
            return
        leaving = {key for node in self._nodes[:count] for key in keys(node)}
        graph = gtsam.NonlinearFactorGraph()
        for factor in (*self._prior, *(self._inertial.pop(n) for n in self._nodes[1 : count + 1])):
            graph.push_back(factor)
        tied = [m for m in self._measured if leaving.intersection(m[2].keys())]
        for _, _, factor in tied:
            graph.push_back(factor)
        _, rest = gtsam.EliminateQR(graph.linearize(self._values), _ordering(self._nodes[:count]))
        self._prior = [gtsam.LinearContainerFactor(rest, self._values_of(rest.keys()))]
        self._measured = [m for m in self._measured if not leaving.intersection(m[2].keys())]
        for key in leaving:
            self._values.erase(key)
        del self._nodes[:count], self._stamps_s[:count]

    def _values_of(self, wanted: Iterable[int]) -> gtsam.Values:
        values = gtsam.Values()
        for key in wanted:
            kind = chr(gtsam.Symbol(key).chr())
            if kind == "x":
                values.insert(key, self._values.atPose3(key))
            elif kind == "v":
                values.insert(key, self._values.atVector(key))
            else:
                values.insert(key, self._values.atConstantBias(key))
        return values


def _ordering(nodes: Iterable[int]) -> gtsam.Ordering:
    ordering = gtsam.Ordering()
    for node in nodes:
        for key in keys(node):
            ordering.push_back(key)
    return ordering
