"""The pose graph over scan pairs, solved incrementally (Mascaro 2020, Sec. 4.2, Eq. 1)."""

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
    """The node of one scan pair.

    Attributes:
        number: From 0, consecutive.
        T_map_cabin: Initial pose, shape (4, 4).
        estimate: The pose by the state estimate.
        is_anchor: Whether that pose is used as a constraint; for a first node it always is.
        odometry: Pose in the previous node by the state estimate; None for a first node.
        match: The same by scan matching; None if nothing matched.
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

    Deviation from the paper: at intervals a node is also constrained to the estimated pose itself,
    since a chain of increments would drift away from the satellite fixes. Nodes beyond a window are
    marginalised, so that the cost does not grow with the length of a mission.

    Attributes:
        restarts: How often the equations had no solution, so that a new graph was started.
    """

    def __init__(self, window: int) -> None:
        """Start empty.

        Args:
            window: Number of nodes that stay; up to half as many more are kept between two
                marginalisations.
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
        self._factors: list[list[gtsam.NonlinearFactor]] = []  # that were added with each node

    def __len__(self) -> int:
        return len(self._nodes)

    def add(self, node: PairNode) -> Poses:
        """Add a node with its constraints; return the poses of all nodes in the window."""
        if len(self._nodes) >= self._window + self._window // 2:
            self._forget()
        if self._nodes and not self._is_tied(node):
            self._restart()
        try:
            self._enter(node)
            return self._solved()
        except RuntimeError:  # GTSAM raises it on a singular system
            self._restart()
            self._enter(node)
            return self._solved()

    def _restart(self) -> None:
        self.restarts += 1
        self._begin()

    def _is_tied(self, node: PairNode) -> bool:
        """Return whether a node is connected to the one before.

        GTSAM would leave an unconnected node at its initial pose without an error.
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
        """Rebuild the graph with its newest nodes, and the marginal of the others as a prior."""
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
        """Return the marginal of all nodes before one, as factors on that node.

        The nodes are a chain, so that no other node is involved.
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
        # Matches share scans, so that a stone that was moved affects several of them.
        kernel = gtsam.noiseModel.mEstimator.Huber.Create(_HUBER)
        noise = gtsam.noiseModel.Robust.Create(kernel, _gaussian(node.match))
        factors.append(gtsam.BetweenFactorPose3(before, key, gtsam.Pose3(node.match.T), noise))
    return factors


def _gaussian(constraint: PoseConstraint) -> gtsam.noiseModel.Gaussian:
    return gtsam.noiseModel.Gaussian.Covariance(constraint.covariance)
