"""The stones on a field of the tests of grasping."""

import runpy
from pathlib import Path

import pytest
from executive_plugins.grasping.sampling.jaw_field import build_jaw_field

_SHARED = runpy.run_path(str(Path(__file__).parents[3] / "plugins" / "grasping" / "conftest.py"))
machine, gripper, planner_of, make_box, make_field, see = (
    _SHARED[name] for name in ("machine", "gripper", "planner_of", "make_box", "make_field", "see")
)


@pytest.fixture(scope="session")
def tables(gripper):
    """The tables of the gripper as planners make them, which takes a second."""
    return build_jaw_field(gripper, 0.03, 0.03)
