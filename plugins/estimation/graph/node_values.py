"""The values of a window's nodes: points about which factors are linear, and steps from them."""

from collections.abc import Iterable, Sequence

import gtsam
import numpy as np
from executive_plugins.estimation.factors import clock_key, extract, insert, keys
from executive_plugins.estimation.inertial.state import Inertial, InertialState


class NodeValues:
    """Linearisation points, close to the estimate, and the steps that lead to it.

    Attributes:
        points: The points.
        steps: From point to estimate, by node; none of a node that was not solved for yet.
        has_clock: Whether each node has a receiver's clock.
    """

    def __init__(self, has_clock: bool) -> None:
        """Make one without nodes."""
        self.points, self.has_clock = gtsam.Values(), has_clock
        self.steps: dict[int, gtsam.VectorValues] = {}

    def copy(self) -> "NodeValues":
        """Return independent values with the same content."""
        twin = NodeValues(self.has_clock)
        twin.points, twin.steps = gtsam.Values(self.points), self.steps.copy()
        return twin

    def insert(self, node: int, state: InertialState, late_s: float) -> None:
        """Insert a node at a state, with a clock that is late by `late_s` if nodes have one."""
        insert(self.points, node, state)
        if self.has_clock:
            self.points.insert(clock_key(node), np.array([late_s]))

    def erase(self, nodes: Iterable[int]) -> None:
        """Erase nodes that were solved for."""
        for node in nodes:
            del self.steps[node]
            for key in (*keys(node), *((clock_key(node),) if self.has_clock else ())):
                self.points.erase(key)

    def state(self, node: int, sample: Inertial) -> InertialState:
        """Return the estimate of a node, at the end of a sample."""
        return extract(self.points, node, sample, self.steps.get(node))

    def late_s(self, node: int) -> float:
        """Return how late the receiver's stamps are at a node [s]; 0 if nodes have no clock."""
        if not self.has_clock:
            return 0.0
        key, step = clock_key(node), self.steps.get(node)
        late_s = float(self.points.atVector(key)[0])
        return late_s if step is None else late_s + float(step.at(key)[0])

    def move_points(self, nodes: Iterable[int]) -> None:
        """Move the points of nodes to the estimate."""
        steps = gtsam.VectorValues()
        for node in nodes:
            if node in self.steps:
                steps.insert(self.steps.pop(node))
        self.points = self.points.retract(steps)

    def points_of(self, wanted: Sequence[int]) -> gtsam.Values:
        """Return the points of keys."""
        values = gtsam.Values()
        for key in wanted:
            kind = chr(gtsam.Symbol(key).chr())
            if kind == "x":
                values.insert(key, self.points.atPose3(key))
            elif kind in "vz":
                values.insert(key, self.points.atVector(key))
            else:
                values.insert(key, self.points.atConstantBias(key))
        return values
