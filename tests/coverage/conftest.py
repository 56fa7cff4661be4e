"""Missions of nodes that need no plugin, and their dry runs."""

import pytest

from executive.coverage.branch import limbs_of
from executive.coverage.sketch import sketch_of
from executive.interfaces.plugin import Plugin
from executive.leaf.action import Action, Condition, Steps
from executive.leaf.outcome import Outcome, succeeded
from executive.tree.catalogue import TableCatalogue
from executive.tree.load import load_mission


class Act(Action):
    """Act."""

    def run(self) -> Steps[None]:
        """Act."""
        yield None
        return succeeded()


class Holds(Condition):
    """Ask."""

    def check(self) -> Outcome[None]:
        """Ask."""
        return succeeded()


HEADER = "api: 1\nmission: small\nplugins: {robot: still, estimation: still}\ntrees:\n  main:\n"
PLUGINS = {"robot": {"still": Plugin}, "estimation": {"still": Plugin}}


@pytest.fixture
def mission(tmp_path):
    def load(main: str, trees: str = ""):
        path = tmp_path / "small.yaml"
        body = "".join(f"    {line}\n" for line in main.strip("\n").splitlines())
        path.write_text(HEADER + body + trees, encoding="utf-8")
        return load_mission(str(path), (), TableCatalogue({"Act": Act, "Holds": Holds}, PLUGINS))

    return load


@pytest.fixture
def branches(mission):
    """Return the branches of a tree as text."""

    def listed(main: str):
        limbs = limbs_of(sketch_of(mission(main)))
        return {str(one) for limb in limbs for one in limb.branches}

    return listed
