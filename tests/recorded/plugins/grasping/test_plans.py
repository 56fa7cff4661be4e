"""Whole plans of thinned planners: a box, refusals of each kind, and the orders of a network."""

import numpy as np
import pytest
from executive_plugins.grasping.sampled_cnn import SampledCnn
from executive_plugins.grasping.settings import SampledCnnSettings

from executive.errors import DataError
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.messages.cloud import Cloud

FEW = {
    "samples": 8,
    "turns_about_y": 3,
    "turns_about_z": 3,
    "downward_yaws": 6,
    "rehearsed": 1,
    "max_grasps": 3,
    "spacing_m": 0.06,
    # Whether one of the drawn lifts holds may depend on the last digits; `kind` has fixed ones.
    "physics": "kind",
}
T = pose(from_rpy(0.02, 0.0, 0.4), np.array([5.0, 1.0, 0.3]))
# The contact solver stops at a tolerance of its own.
RELATIVE = 1e-5


@pytest.fixture
def planner_with(planner_of, tables):
    """Return a maker of planners that share the tables of the gripper."""

    def make(*reach_m, **settings):
        planner = planner_of(*reach_m, **settings)
        planner._sampler._tables = tables
        return planner

    return make


@pytest.fixture
def seen(make_box, make_field, see):
    """A box on a field."""
    return see(make_box((1.0, 0.7, 0.6), 0.05), make_field(2.5, 0.08, np.array([0.5, 0.35])), T)


@pytest.mark.parametrize(
    "changed",
    [
        {},
        {"rehearsed": 0},
        {"max_slip_m": 0.01, "rehearsed": 1},
        {"keep_aligned": 3, "keep_enclosing": 1, "rehearsed": 0},
        {"approach_m": 9.0, "rehearsed": 0},
        {"density": 9000.0},
        {"density": 4500.0, "rehearsed": 0},
    ],
)
def test_plans(recorded, planner_with, seen, changed) -> None:
    planner = planner_with(**FEW | changed)
    told = planner.plan(*seen, np.eye(4), np.random.default_rng(1))
    recorded(told, relative=RELATIVE)


def test_refusals(recorded, planner_with, seen, make_box, make_field, see) -> None:
    stone, cloud = seen
    planner = planner_with(6.0, **FEW | {"rehearsed": 0})
    rng = np.random.default_rng(2)
    far = pose(t=np.array([-4.0, 0.0, 0.0]))
    told = [planner.plan(stone, cloud, far, rng)]
    wide = see(make_box((2.6, 2.5, 0.1), 0.1), make_field(3.0, 0.15, np.array([1.3, 1.3])))
    told.append(planner.plan(*wide, np.eye(4), rng))
    few = see(make_box((1.0, 0.7, 0.6), 0.05)[:19], make_field(1.0, 0.2))
    told.append(planner.plan(*few, np.eye(4), rng))
    with pytest.raises(DataError) as refused:
        planner.plan(stone, Cloud("odom", cloud.points), np.eye(4), rng)
    recorded((told, refused.value))


PAPER = {"ranking": "paper", "min_success": 0.2, "rehearsed": 0}


@pytest.mark.parametrize("changed", [{"rehearsed": 1}, PAPER, {"rehearsed": 0}])
def test_network_plans(recorded, machine, planner_of, tables, seen, changed) -> None:
    motion = planner_of()._arm._motion
    planner = SampledCnn(SampledCnnSettings(**FEW | {"max_slip_m": 1.0} | changed), machine, motion)
    planner._sampler._tables = tables
    told = planner.plan(*seen, np.eye(4), np.random.default_rng(1))
    # The network computes in single precision, and rounds to three digits.
    recorded(told, relative=1e-4, absolute=1.1e-3)
