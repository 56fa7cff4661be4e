"""The pose graph over scan pairs, solved step by step (Mascaro 2020, Sec. 4.2, Eq. 1)."""

from dataclasses import dataclass

import gtsam
import numpy as np
from executive_plugins.mapping.pose_constraint import PoseConstraint
from gtsam.symbol_shorthand import X

from executive.arrays import Float

_HUBER = 1.345  # 95 % efficient on Gaussian noise
_RELINEARISE = 1e-3  # rad, m


@dataclass(frozen=True, slots=True, eq=False)
class PairNode:
    """One scan pair's place in the graph.

    Attributes:
        number: From 0, one after the other.
        T_map_cabin: First guess, shape (4, 4).
        estimate: The state estimate's own word on the pose.
        is_anchor: Whether that word counts; for a first node it always does.
        odometry: The pose in the node before, by the estimate's increment; None for a first node.
        match: The same by scan matching; None where nothing matched.
    """

    number: int
    T_map_cabin: Float
    estimate: PoseConstraint
    is_anchor: bool
    odometry: PoseConstraint | None = None
    match: PoseConstraint | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Poses:
    """Poses of consecutive nodes.

    Attributes:
        first: Number of the first.
        T_map_cabin: Shape (N, 4, 4).
    """

    first: int
    T_map_cabin: Float


class PairGraph:
    """iSAM2 over the newest nodes.

    Deviation from the paper: now and then a node is tied to the state estimate itself, not only to
    its increments. A chain of increments would walk away from the satellites; and nodes beyond a
    window are forgotten, their knowledge kept as a prior, so that a long mission costs no more than
    a short one.

    Attributes:
        restarts: How often the equations had no solution, and the graph began anew.
    """

    def __init__(self, window: int) -> None:
        """Begin empty.

        Args:
            window: Nodes that stay; up to half as many more are there between two clearings.
        """
        self._window = window
        self.restarts = 0
        self._begin()

    def _begin(self) -> None:
        parameters = gtsam.ISAM2Params()
        parameters.setRelinearizeThreshold(_RELINEARISE)
        parameters.relinearizeSkip = 1
        self._isam = gtsam.ISAM2(parameters)
        self._nodes: list[PairNode] = []
        self._factors: list[list[gtsam.NonlinearFactor]] = []  # that came with each node

    def __len__(self) -> int:
        return len(self._nodes)

    def add(self, node: PairNode) -> Poses:
        """Add a node with its constraints; return where all nodes in the window are now."""
        if len(self._nodes) >= self._window + self._window // 2:
            self._forget()
        if self._nodes and not self._is_tied(node):
            self._restart()
        try:
            self._enter(node)
            return self._solved()
        except RuntimeError:  # what GTSAM throws on a singular system
            self._restart()
            self._enter(node)
            return self._solved()

    def _restart(self) -> None:
        self.restarts += 1
        self._begin()

    def _is_tied(self, node: PairNode) -> bool:
        """Say whether a node hangs on the one before; GTSAM would leave it at its first guess, and
        say nothing.
        """
        is_next = node.number == self._nodes[-1].number + 1
        return is_next and not (node.odometry is None and node.match is None)

    def _enter(self, node: PairNode) -> None:
        factors = _between(node) + _anchors(node) if self._nodes else [_tie(node)]
        self._update(node, node.T_map_cabin, factors)

    def _update(
        self, node: PairNode, T_map_cabin: Float, factors: list[gtsam.NonlinearFactor]
    ) -> None:
        graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        for factor in factors:
            graph.push_back(factor)
        values.insert(X(node.number), gtsam.Pose3(T_map_cabin))
        self._isam.update(graph, values)
        self._nodes.append(node)
        self._factors.append(factors)

    def _solved(self) -> Poses:
        values = self._isam.calculateEstimate()
        poses = np.array([values.atPose3(X(node.number)).matrix() for node in self._nodes])
        if not np.isfinite(poses).all():
            raise RuntimeError("the solution is not finite")
        return Poses(self._nodes[0].number, poses)

    def _forget(self) -> None:
        """Rebuild the graph on its newest nodes; what the older ones knew becomes a prior on the
        oldest of them.
        """
        T = self._solved().T_map_cabin
        nodes, factors = self._nodes, self._factors
        first = len(nodes) - self._window
        prior = self._summary(nodes[first], [one for of_node in factors[:first] for one in of_node])
        self._begin()
        for k in range(first, len(nodes)):
            self._update(nodes[k], T[k], factors[k] if k > first else prior + _anchors(nodes[k]))

    def _summary(
        self, kept: PairNode, old: list[gtsam.NonlinearFactor]
    ) -> list[gtsam.NonlinearFactor]:
        """Eliminate all nodes before one, for the nodes are a chain: what is left is a factor on
        that one alone.
        """
        values, graph, ordering = (
            self._isam.calculateEstimate(),
            gtsam.NonlinearFactorGraph(),
            gtsam.Ordering(),
        )
        for factor in old + _between(kept):
            graph.push_back(factor)
        for node in self._nodes:
            if node.number < kept.number:
                ordering.push_back(X(node.number))
        _, rest = graph.linearize(values).eliminatePartialSequential(ordering)
        there = gtsam.Values()
        there.insert(X(kept.number), values.atPose3(X(kept.number)))
        return [
            gtsam.LinearContainerFactor(rest.at(i), there)
            for i in range(rest.size())
            if rest.at(i) is not None
        ]


def _tie(node: PairNode) -> gtsam.NonlinearFactor:
    return gtsam.PriorFactorPose3(
        X(node.number), gtsam.Pose3(node.estimate.T), _gaussian(node.estimate)
    )


def _anchors(node: PairNode) -> list[gtsam.NonlinearFactor]:
    return [_tie(node)] if node.is_anchor else []


def _between(node: PairNode) -> list[gtsam.NonlinearFactor]:
    before, key = X(node.number - 1), X(node.number)
    factors: list[gtsam.NonlinearFactor] = []
    if node.odometry is not None:
        odometry = node.odometry
        factors.append(
            gtsam.BetweenFactorPose3(before, key, gtsam.Pose3(odometry.T), _gaussian(odometry))
        )
    if node.match is not None:
        # Matches share their scans, and a stone that is moved pulls at several of them.
        kernel = gtsam.noiseModel.mEstimator.Huber.Create(_HUBER)
        noise = gtsam.noiseModel.Robust.Create(kernel, _gaussian(node.match))
        factors.append(gtsam.BetweenFactorPose3(before, key, gtsam.Pose3(node.match.T), noise))
    return factors


def _gaussian(constraint: PoseConstraint) -> gtsam.noiseModel.Gaussian:
    return gtsam.noiseModel.Gaussian.Covariance(constraint.covariance)
