"""The fixture that compares an answer with the recorded one."""

import importlib
import json
import pkgutil
import runpy
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from pydantic.fields import FieldInfo

from executive.config import Settings
from executive.interfaces.plugin import Plugin
from executive.machine.machine import Machine, load_machine
from executive.testing.exercise import exercise_of
from executive.testing.subject import subject_of

HERE = Path(__file__).parent
RECORDER = "recorder"  # the name of the plugin of pytest that `record.py` brings
RELATIVE = 1e-9  # plain arithmetic differs by less between processors and versions of libraries


VALUES = SimpleNamespace(**runpy.run_path(str(HERE / "values.py")))


@pytest.fixture
def recorded(request: pytest.FixtureRequest) -> Callable[..., None]:
    """Compare answers with those in the JSON file beside the test; `record.py` writes them.

    `recorded(answer)` may be called several times, in one order. Give `relative` or `absolute`
    where a library's threads or iterations decide the last digits, and say why there.
    """
    path = request.path.with_suffix(".json")
    test, calls = request.node.name, [0]
    recorder = request.config.pluginmanager.get_plugin(RECORDER)

    def compare(answer: Any, relative: float = RELATIVE, absolute: float = VALUES.ABSOLUTE) -> None:
        name = test if not calls[0] else f"{test} {calls[0] + 1}"
        calls[0] += 1
        got = json.loads(json.dumps(VALUES.plain(answer)))
        if recorder is not None:
            recorder.take(path, name, got)
            return
        known = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
        assert name in known, f"{name} is not recorded: python tests/recorded/record.py {path.stem}"
        found = list(VALUES.differences(got, known[name], relative, absolute))
        assert not found, "\n".join(
            [f"{len(found)} values differ from {path.name}, {name}:", *found[:10]]
        )

    return compare


@pytest.fixture(scope="session")
def machine() -> Machine:
    """The shipped machine."""
    return load_machine("m545")


@pytest.fixture
def settings_in() -> Callable[[str], Any]:
    """Return what a package declares: defaults and bounds of settings, latencies of plugins."""

    def classes(of: type) -> Iterator[type]:
        for one in of.__subclasses__():
            yield one
            yield from classes(one)

    def fields(package: str) -> Any:
        for module in pkgutil.walk_packages(
            importlib.import_module(package).__path__, package + "."
        ):
            importlib.import_module(module.name)
        found = [one for one in classes(Settings) if f"{one.__module__}.".startswith(f"{package}.")]
        bounds = {
            one.__name__: {
                name: [repr(field.get_default(call_default_factory=True)), _bounds(field)]
                for name, field in one.model_fields.items()
            }
            for one in sorted(found, key=lambda one: one.__qualname__)
        }
        plugins = [one for one in classes(Plugin) if f"{one.__module__}.".startswith(f"{package}.")]
        declared = {one.__name__: [one.latency_s, one.is_stateless] for one in plugins}
        return bounds, dict(sorted(declared.items()))

    return fields


def _bounds(field: FieldInfo) -> str:
    known = (one for one in field.metadata if type(one).__module__ == "annotated_types")
    return " ".join(sorted(map(repr, known)))


@pytest.fixture
def exercised() -> Callable[..., Any]:
    """Return what a plugin answers to the ordinary inputs of the conformance kit."""

    def answer(capability: str, name: str, *options: str) -> Any:
        subject, exercise = subject_of(capability, name, options), exercise_of(capability)
        assert exercise is not None
        with subject.started() as plugin:
            return exercise.run(plugin, exercise.inputs(subject.machine))

    return answer


@pytest.fixture
def hostile() -> Callable[..., dict[str, Any]]:
    """Return what a plugin answers to each of the kit's hostile inputs, errors included."""

    def answers(capability: str, name: str, *options: str) -> dict[str, Any]:
        subject, exercise = subject_of(capability, name, options), exercise_of(capability)
        assert exercise is not None
        told = {}
        for case, call in exercise.hostile(subject.machine).items():
            with subject.started() as plugin:
                try:
                    told[case] = call(plugin)
                except exercise.may_raise as error:
                    told[case] = type(error).__name__
        return told

    return answers
