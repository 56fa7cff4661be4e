"""The life of every plugin: started once, closed once or more, whatever happened between."""

from contextlib import ExitStack

import pytest

from executive.testing.exercise import AnyExercise
from executive.testing.subject import Subject


def test_it_starts_and_closes(subject: Subject) -> None:
    with subject.started() as plugin:
        assert isinstance(plugin, subject.plugin_class)


def test_it_can_be_closed_twice(subject: Subject) -> None:
    with subject.started() as plugin:
        plugin.close()


def test_it_can_be_closed_without_a_start(subject: Subject) -> None:
    with ExitStack() as stack:
        subject.make(stack).close()


def test_it_can_be_closed_after_a_refused_input(subject: Subject, exercise: AnyExercise) -> None:
    calls = exercise.hostile(subject.machine)
    if not calls:
        pytest.skip(f"the exercise of {subject.capability} has no hostile input")
    with subject.started() as plugin:
        try:
            next(iter(calls.values()))(plugin)
        except exercise.may_raise:
            plugin.close()
