"""A stone that met the ground early has arrived; one that fell, or that is far off, has not."""

import numpy as np
import pytest

from executive.behaviours.has_arrived import HasArrived, HasArrivedSettings
from executive.geometry.pose import pose
from executive.messages.placement import Placement, Slot
from executive.messages.verdict import Trouble, Verdict


def placement_at(x, z):
    """The fake gripper stands at x = 5 m, z = 2 m."""
    return Placement(Slot(1, np.array([x, 0, 0])), pose(t=np.array([x, 0.0, z])), np.eye(4))


@pytest.mark.parametrize(
    ("x", "z", "has_arrived"),
    [(5.0, 2.0, True), (5.0, 1.8, True), (5.08, 1.9, True), (5.2, 2.0, False), (5.0, 1.6, False)],
)
def test_judges_by_the_grippers_distance(fakes, x, z, has_arrived):
    context = fakes.Context(monitoring=())
    context.troubles = [Verdict(1.0, "jaw_slip", Trouble.SLIP, "")]
    outcome = HasArrived(HasArrivedSettings(), context).check(placement=placement_at(x, z))
    assert outcome.success is has_arrived


def test_a_stone_that_fell_has_not_arrived(fakes):
    context = fakes.Context(monitoring=())
    context.troubles = [Verdict(1.0, "payload_drop", Trouble.DROP, "")]
    assert (
        not HasArrived(HasArrivedSettings(), context)
        .check(placement=placement_at(5.0, 2.0))
        .success
    )
