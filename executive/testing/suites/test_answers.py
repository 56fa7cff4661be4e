"""The answers of every plugin: the same each time, in each process, to inputs that stay."""

import pickle
from collections.abc import Callable

import pytest

from executive.interfaces.plugin import Plugin
from executive.messages.parts import place_of_nan
from executive.testing.digest import digest, first_difference
from executive.testing.exercise import AnyExercise
from executive.testing.first_answer import Answer, answer_of
from executive.testing.spawned import spawned_digest
from executive.testing.subject import Subject

SPAWN_S = 60.0  # a new process imports the plugin's libraries; the slowest take some seconds


def test_it_answers(first_answer: Answer) -> None:
    if first_answer.error is not None:
        raise first_answer.error


def test_its_inputs_stay_as_they_were(first_answer: Answer) -> None:
    before, after = first_answer.inputs_before, first_answer.inputs_after
    changed = [path for (path, was), (_, is_) in zip(before, after, strict=True) if was != is_]
    assert not changed, f"it wrote to {', '.join(changed)}: arrays are read-only, work on a copy"


def test_it_gives_the_same_bytes_twice(
    subject: Subject, exercise: AnyExercise, answered: Answer
) -> None:
    if getattr(subject.plugin_class, "has_own_clock", False):
        pytest.skip("it lives by its own clock: what it measures depends on when it is read")
    again = answer_of(subject, exercise)
    place = first_difference(answered.value, again.value)
    assert not place, f"two runs with one seed differ at {place}"


def test_its_answers_hold_no_nan(answered: Answer) -> None:
    place = place_of_nan(answered.value)
    assert not place, f"{place} is not a number"


def test_its_answers_survive_a_pickle(answered: Answer) -> None:
    again = pickle.loads(pickle.dumps(answered.value))
    assert digest(again) == digest(answered.value)


def test_its_verbs_end_in_time(subject: Subject, answered: Answer, time_limit_s: float) -> None:
    for verb, longest_s in answered.longest_s.items():
        limit_s = max(time_limit_s, subject.plugin_class.latency_s.get(verb, 0.0))
        assert longest_s <= limit_s, f"{verb} took {longest_s:.1f} s, the limit is {limit_s:.1f} s"


def test_a_spawned_process_gives_the_same_answer(
    subject: Subject, answered: Answer, time_limit_s: float
) -> None:
    if not subject.plugin_class.is_stateless:
        pytest.skip("it does not say is_stateless: no worker process computes its verbs")
    limit_s = SPAWN_S + time_limit_s * max(1, len(answered.longest_s))
    assert spawned_digest(subject, limit_s) == digest(answered.value), (
        "it says is_stateless, and a copy in another process answers something else"
    )


def test_a_hostile_input_gives_a_value_or_a_refusal(
    shared: Plugin | None,
    make: Callable[[], Plugin],
    subject: Subject,
    exercise: AnyExercise,
    hostile_input: str,
) -> None:
    plugin = make() if shared is None else shared
    try:
        value = exercise.hostile(subject.machine)[hostile_input](plugin)
    except exercise.may_raise as refusal:
        assert str(refusal), "the refusal says nothing"  # noqa: PT017 - either outcome is right
        return
    place = place_of_nan(value)
    assert not place, f"{hostile_input} gives a value whose {place} is not a number"
