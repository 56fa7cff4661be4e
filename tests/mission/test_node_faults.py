"""A fault that has stopped the mission is handed up through the nodes as it is."""

from types import SimpleNamespace

import pytest

from executive.leaf.runtime import MissionFaultError
from executive.mission.node_runtime import NodeRuntime


class Errors:
    def __init__(self, excuses):
        self.asked, self._excuses = [], excuses

    def fault_of(self, error, node, leaf):
        self.asked.append((str(error), node, leaf))
        return SimpleNamespace(summary=f"{leaf} of {node}: {error}")

    def excuses(self, fault):
        return self._excuses


def runtime(excuses=False):
    faults = []
    return SimpleNamespace(_errors=Errors(excuses), _fault=faults.append, faults=faults)


def test_a_fault_that_was_told_is_not_told_again_by_the_nodes_above():
    one, fault = runtime(excuses=True), MissionFaultError("drops of oil")
    with pytest.raises(MissionFaultError) as raised:
        NodeRuntime.fail(one, fault, "main/0", "Pick")
    assert raised.value is fault
    assert not one.faults
    assert not one._errors.asked


def test_an_error_stops_the_mission_with_its_cause():
    one, error = runtime(), ValueError("no")
    with pytest.raises(MissionFaultError, match="Pick of main/0: no") as raised:
        NodeRuntime.fail(one, error, "main/0", "Pick")
    assert raised.value.__cause__ is error
    assert [fault.summary for fault in one.faults] == ["Pick of main/0: no"]


def test_an_error_of_a_plugin_that_may_fail_is_a_failure_of_the_leaf():
    one = runtime(excuses=True)
    assert NodeRuntime.fail(one, ValueError("no"), "main/0", "Pick") == "Pick of main/0: no"
    assert not one.faults
