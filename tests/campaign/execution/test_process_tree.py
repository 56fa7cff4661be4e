"""The processes of a run are found by their parents, and a number may be given a second time."""

import os
import signal

import psutil
import pytest

from executive.campaign.execution.processes import process_tree
from executive.campaign.execution.processes.process_tree import ProcessTree


class Process:
    """A process of a computer that a test makes up."""

    def __init__(self, pid, memory=100):
        self.pid, self.memory, self.has_ended, self.was_killed = pid, memory, False, False

    def memory_info(self):
        if self.has_ended:
            raise psutil.NoSuchProcess(self.pid)
        return type("Info", (), {"rss": self.memory})()

    def is_running(self):
        return not self.has_ended

    def kill(self):
        if self.has_ended:
            raise psutil.NoSuchProcess(self.pid)
        self.was_killed = True


@pytest.fixture
def computer(monkeypatch):
    """Return processes by number, children by number, and the groups that were killed."""
    processes, children, groups = {}, {}, []

    def process(pid):
        if pid not in processes:
            raise psutil.NoSuchProcess(pid)
        return processes[pid]

    monkeypatch.setattr(process_tree.psutil, "Process", process)
    monkeypatch.setattr(process_tree, "_children_of", lambda pid: children.get(pid, []))
    monkeypatch.setattr(os, "killpg", lambda pid, number: groups.append((pid, number)))
    for pid in (1, 2, 3):
        processes[pid] = Process(pid, 100 * pid)
    return processes, children, groups


def test_descendants_of_any_depth_count(computer):
    _, children, _ = computer
    tree = ProcessTree(1)
    assert tree.resident_bytes() == 100
    children.update({1: [2], 2: [3]})
    assert tree.resident_bytes() == 600


def test_a_child_whose_parent_has_ended_is_known_from_before(computer):
    processes, children, _ = computer
    tree = ProcessTree(1)
    children.update({1: [2], 2: [3]})
    tree.resident_bytes()
    processes[2].has_ended = True
    children.clear()
    assert tree.resident_bytes() == 400


def test_a_number_that_is_given_to_a_new_process_is_found_again(computer):
    processes, children, _ = computer
    tree = ProcessTree(1)
    children[1] = [2]
    tree.resident_bytes()
    processes[2].has_ended = True
    assert tree.resident_bytes() == 100
    processes[2] = Process(2, 5000)
    assert tree.resident_bytes() == 5100


def test_all_are_killed_and_the_leader_with_its_group(computer):
    processes, children, groups = computer
    tree = ProcessTree(1)
    children.update({1: [2], 2: [3]})
    processes[3].has_ended = True
    tree.kill()
    assert groups == [(1, signal.SIGKILL)]
    assert [processes[pid].was_killed for pid in (1, 2, 3)] == [True, True, False]


def test_the_group_of_a_leader_that_has_ended_is_left_alone(computer):
    processes, children, groups = computer
    tree = ProcessTree(1)
    children[1] = [2]
    tree.resident_bytes()
    processes[1].has_ended = True
    tree.kill()
    assert groups == []
    assert processes[2].was_killed


def test_a_process_that_has_ended_already_has_no_memory_and_no_group(computer):
    _, _, groups = computer
    tree = ProcessTree(9)
    assert tree.resident_bytes() == 0
    tree.kill()
    assert groups == []
