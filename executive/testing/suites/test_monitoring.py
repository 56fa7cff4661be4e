"""What every monitor must do, whatever it watches."""

from executive.interfaces.monitoring import Monitor
from executive.machine.machine import Machine
from executive.testing.exercises.monitoring import constant, feed, lost
from executive.testing.pytest_plugin import Insist
from executive.testing.subject import Subject

CAPABILITY = "monitoring"


def test_says_nothing_about_a_steady_hold(plugin: Monitor, machine: Machine) -> None:
    plugin.begin_hold()
    assert feed(plugin, machine, constant(0.4), constant(2.5e5)) == []


def test_says_once_that_the_stone_is_gone_and_since_when(
    plugin: Monitor, machine: Machine, subject: Subject, insist: Insist
) -> None:
    plugin.begin_hold()
    told = feed(plugin, machine, lost(0.4, 0.0), lost(2.5e5, 0.0))
    insist(told, "it says nothing about a stone that is lost")
    assert len(told) == 1
    assert 5.0 <= told[0].stamp_s <= 8.0
    assert told[0].monitor == subject.name, "a verdict bears its monitor's name"
    assert told[0].detail


def test_says_so_of_a_stone_that_was_found_to_hang_before(
    plugin: Monitor, machine: Machine, insist: Insist
) -> None:
    plugin.begin_hold()
    plugin.begin_carry()
    told = feed(plugin, machine, lost(0.4, 0.0), lost(2.5e5, 0.0))
    insist(told, "it says nothing about a stone that is lost")
    assert len(told) == 1


def test_says_nothing_unless_something_is_held(plugin: Monitor, machine: Machine) -> None:
    assert feed(plugin, machine, lost(0.4, 0.0), lost(2.5e5, 0.0)) == []
    plugin.begin_hold()
    plugin.end_hold()
    assert feed(plugin, machine, lost(0.4, 0.0), lost(2.5e5, 0.0)) == []


def test_each_hold_is_judged_anew(plugin: Monitor, machine: Machine, insist: Insist) -> None:
    for _ in range(2):
        plugin.begin_hold()
        told = feed(plugin, machine, lost(0.4, 0.0), lost(2.5e5, 0.0))
        insist(told, "it says nothing about a stone that is lost")
        assert len(told) == 1
