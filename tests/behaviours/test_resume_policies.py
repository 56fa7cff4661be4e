"""Every shipped leaf declares what becomes of it when a run is cut off."""

import numpy as np
import pytest

from executive import registry
from executive.leaf.memory import OnResume
from executive.leaf.rest_of_path import rest_of
from executive.messages.trajectory import JointTrajectory

LEAVES = {one.name: registry.load("behaviour", one.name) for one in registry.installed("behaviour")}


@pytest.mark.parametrize("name", sorted(LEAVES))
def test_a_shipped_leaf_declares_its_policy(name):
    leaf = LEAVES[name]
    assert isinstance(leaf.on_resume, OnResume), name
    if leaf.on_resume is OnResume.VERIFY:
        assert "verify" in vars(leaf)


def test_what_opens_or_closes_the_jaws_is_on_the_disk_before():
    assert {name for name, leaf in LEAVES.items() if leaf.is_irreversible} >= {
        "CloseGripper",
        "OpenGripper",
        "ReleaseStone",
    }


TIMES = np.linspace(0.0, 4.0, 41)
S = TIMES / 4
PATH = JointTrajectory(
    ("a", "b"),
    TIMES,
    np.outer(3 * S**2 - 2 * S**3, [1.0, -0.5]),
    np.outer((6 * S - 6 * S**2) / 4, [1.0, -0.5]),
)


@pytest.mark.parametrize("stopped_s", [0.0, 0.7, 2.0, 3.5, 4.0])
def test_the_rest_of_a_path_begins_at_rest_and_stays_on_it(stopped_s):
    rest = rest_of(PATH, PATH.at(stopped_s)[0])
    assert np.allclose(rest.position[0], PATH.at(stopped_s)[0])
    assert np.allclose(rest.position[-1], PATH.position[-1])
    assert np.allclose(rest.velocity[[0, -1]], 0.0)
    assert np.allclose(rest.position @ [0.5, 1.0], 0.0, atol=1e-3)  # on the path, a line
    assert np.abs(rest.velocity).max() <= np.abs(PATH.velocity).max() + 1e-9


def test_an_arm_beside_its_path_has_no_rest_of_it():
    assert rest_of(PATH, PATH.at(2.0)[0] + [0.1, 0.1]) is None
