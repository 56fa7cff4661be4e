"""Poses of the newest nodes: from the graph as far as it has answered, then from odometry."""

from collections import deque

import numpy as np
from executive_plugins.mapping.pair_graph import Poses

from executive.arrays import Float


class NodeTrack:
    """Poses and increments of the newest nodes, numbered from 0 without gaps."""

    def __init__(self, most: int) -> None:
        """Start empty; at most this many nodes are kept."""
        self._first = 0
        self._increments: deque[Float] = deque(maxlen=most)
        self._poses: deque[Float] = deque(maxlen=most)

    @property
    def next_number(self) -> int:
        """Number that the next node will have."""
        return self._first + len(self._poses)

    def append(self, T_before_this: Float, T_map_cabin: Float) -> None:
        """Add a node with its initial pose."""
        self._first += len(self._poses) == self._poses.maxlen
        self._increments.append(T_before_this)
        self._poses.append(T_map_cabin)

    def take(self, poses: Poses) -> None:
        """Take the graph's poses, and propagate them to newer nodes by the increments."""
        end = poses.first + len(poses.T_map_cabin)
        for number in range(max(poses.first, self._first), self.next_number):
            i = number - self._first
            if number < end:
                self._poses[i] = poses.T_map_cabin[number - poses.first]
            elif i > 0:
                self._poses[i] = self._poses[i - 1] @ self._increments[i]

    def pose_of(self, number: int) -> Float:
        """Return T_map_cabin of a node that is still kept, shape (4, 4)."""
        return self._poses[number - self._first]

    def poses(self) -> Poses:
        """Return the poses of all nodes that are kept."""
        return Poses(self._first, np.array(self._poses))
