"""Options and fixtures of the kit: `pytest -p executive.testing.pytest_plugin --pyargs …`."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import Any

import pytest

from executive import registry
from executive.errors import ConfigError
from executive.interfaces.plugin import Plugin
from executive.machine.machine import Machine
from executive.testing.exercise import AnyExercise, exercise_of
from executive.testing.first_answer import Answer, answer_of
from executive.testing.subject import Subject, subject_of

Insist = Callable[[object, str], None]  # see the fixture `insist`
TIME_LIMIT_S = 30.0  # generous: ten times what the slowest shipped verb takes on a laptop


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options that choose what is held to its contract."""
    group = parser.getgroup("executive", "the conformance kit of executive")
    group.addoption("--capability", help="Check plugins of this capability; all by default.")
    group.addoption("--plugin", help="Check the plugin of this name; all by default.")
    group.addoption(
        "--set",
        action="append",
        default=[],
        metavar="CAPABILITY.FIELD=VALUE",
        help="Change a setting, or give a chosen plugin for a capability that it needs.",
    )
    group.addoption("--model", default="m545", help="The machine that it is made for.")
    group.addoption(
        "--time-limit",
        type=float,
        default=TIME_LIMIT_S,
        help="Longest call of any verb in seconds; a larger declared latency counts instead.",
    )
    group.addoption(
        "--must-succeed",
        action="store_true",
        help="A plugin that refuses what a capable one answers fails; otherwise it is skipped.",
    )


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Give each check the plugins that it is for, and the hostile inputs of their capability."""
    if "leaf" in metafunc.fixturenames:
        metafunc.parametrize("leaf", _leaves(metafunc.config))
    if "subject" not in metafunc.fixturenames:
        return
    subjects = _subjects(metafunc.config, getattr(metafunc.module, "CAPABILITY", None))
    if "hostile_input" in metafunc.fixturenames:
        cases = [(subject, name) for subject in subjects for name in _hostile(subject)]
        ids = [f"{name}-{subject.name}" for subject, name in cases]
        metafunc.parametrize(("subject", "hostile_input"), cases, ids=ids, scope="module")
    else:
        ids = [subject.name for subject in subjects]
        metafunc.parametrize("subject", subjects, ids=ids, scope="module")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out checks that are for none of the chosen plugins."""
    empty = [
        item
        for item in items
        if isinstance(item, pytest.Function)
        and "subject" in item.fixturenames
        and not isinstance(item.callspec.params.get("subject"), Subject)
    ]
    if empty:
        config.hook.pytest_deselected(items=empty)
        items[:] = [item for item in items if item not in empty]


def _subjects(config: pytest.Config, capability: str | None) -> list[Subject]:
    wanted, name = config.getoption("--capability"), config.getoption("--plugin")
    known = (*registry.capabilities(), registry.SMOOTHERS)
    installed = [
        one
        for each in ([capability] if capability else known)
        if wanted in (None, each)
        for one in registry.installed(each)
        if name in (None, one.name)
    ]
    return [made for one in installed if (made := _subject(config, one, name)) is not None]


def _subject(config: pytest.Config, one: registry.Installed, wanted: str | None) -> Subject | None:
    options, model = config.getoption("--set"), config.getoption("--model")
    try:
        return subject_of(one.capability, one.name, options, model)
    except ConfigError as error:
        if wanted is not None:
            raise pytest.UsageError(str(error)) from error
        return None  # it has settings without a default: ask for it by name, with --set


def _leaves(config: pytest.Config) -> list[Any]:
    """Return the chosen leaves by name."""
    wanted, name = config.getoption("--capability"), config.getoption("--plugin")
    names = [one.name for one in registry.installed(registry.BEHAVIOURS)]
    chosen = [n for n in names if wanted in (None, "leaf") and name in (None, n)]
    return [pytest.param(registry.load(registry.BEHAVIOURS, n), id=n) for n in chosen]


def _hostile(subject: Subject) -> list[str]:
    exercise = exercise_of(subject.capability)
    return list(exercise.hostile(subject.machine)) if exercise else []


@pytest.fixture
def make(subject: Subject) -> Iterator[Callable[[], Plugin]]:
    """Make started plugins; all are closed at the end."""
    with ExitStack() as stack:
        yield lambda: stack.enter_context(subject.started())


@pytest.fixture(scope="module")
def shared(subject: Subject) -> Iterator[Plugin | None]:
    """One plugin for many calls where it says is_stateless, to start it once; else None."""
    if not subject.plugin_class.is_stateless:
        yield None
        return
    with subject.started() as plugin:
        yield plugin


@pytest.fixture
def plugin(make: Callable[[], Plugin]) -> Plugin:
    """One started plugin of its own for each check."""
    return make()


@pytest.fixture(scope="module")
def machine(subject: Subject) -> Machine:
    """The machine that the plugin is made for."""
    return subject.machine


@pytest.fixture
def exercise(subject: Subject) -> AnyExercise:
    """The exercise of the plugin's capability."""
    found = exercise_of(subject.capability)
    if found is None:
        pytest.skip(f"no installed package has an exercise for '{subject.capability}'")
    return found


@pytest.fixture(scope="module")
def first_answer(subject: Subject) -> Answer:
    """One ordinary run, shared by the checks that only look at it."""
    found = exercise_of(subject.capability)
    if found is None:
        pytest.skip(f"no installed package has an exercise for '{subject.capability}'")
    return answer_of(subject, found)


@pytest.fixture
def answered(first_answer: Answer, insist: Insist) -> Answer:
    """The ordinary run of a plugin that answered."""
    if first_answer.error is not None:
        pytest.skip("it gave no answer: see the check that it answers")
    insist(not first_answer.refusal, first_answer.refusal)
    return first_answer


@pytest.fixture
def insist(request: pytest.FixtureRequest) -> Insist:
    """Demand an answer that a capable plugin gives.

    A refusal with a reason breaks no contract, but leaves nothing to check: it is skipped with its
    reason, unless the run has `--must-succeed`.
    """

    def demand(is_met: object, reason: str) -> None:
        if is_met:
            return
        if request.config.getoption("--must-succeed"):
            pytest.fail(f"it refuses: {reason}")
        pytest.skip(f"it refuses: {reason}")

    return demand


@pytest.fixture(scope="session")
def time_limit_s(request: pytest.FixtureRequest) -> float:
    """Longest call of any verb [s]."""
    return float(request.config.getoption("--time-limit"))
