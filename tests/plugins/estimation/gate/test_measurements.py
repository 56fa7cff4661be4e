"""Measurements that wait for an inertial sample."""

import heapq

import numpy as np
from executive_plugins.estimation.gate.measurements import Fix, PendingMeasurement


def test_fixes_of_one_moment_can_wait_together() -> None:
    z = np.zeros(3)
    queue = [
        PendingMeasurement(stamp_s, Fix(stamp_s, antenna, z, z, np.eye(3)))
        for stamp_s, antenna in ((2.0, "left"), (1.0, "left"), (2.0, "right"), (1.0, "right"))
    ]
    heapq.heapify(queue)
    assert [heapq.heappop(queue).stamp_s for _ in range(4)] == [1.0, 1.0, 2.0, 2.0]
