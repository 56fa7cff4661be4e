"""One run of the kit over one plugin: pytest within this process, its outcome as findings."""

import contextlib
import inspect
import io
import os
import traceback
from collections.abc import Generator, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

import pytest

from executive import registry
from executive.errors import ConfigError, did_you_mean
from executive.mission.fault import place_of
from executive.testing import suites
from executive.testing.finding import Finding, Outcome, words
from executive.testing.subject import subject_of

LEAF = "leaf"
_SUITES = Path(suites.__file__).parent
_PLUGINS = ("executive.testing.pytest_plugin", "no:cacheprovider", "no:terminal")
_QUIET = (*(f"-p{name}" for name in _PLUGINS), "--import-mode=importlib", "-s", f"-c{os.devnull}")
_AUTOLOAD = "PYTEST_DISABLE_PLUGIN_AUTOLOAD"


@dataclass(frozen=True, slots=True)
class Trial:
    """Which plugin is held to its contract, and how strictly.

    Attributes:
        capability: Its capability, or `leaf`.
        name: Its name.
        options: Settings and companions, as `--set` takes them.
        model: The machine that it is made for.
        time_limit_s: Longest call of any verb [s].
        must_succeed: Whether a refusal of what a capable plugin answers is a failure.
    """

    capability: str
    name: str
    options: tuple[str, ...] = ()
    model: str = "m545"
    time_limit_s: float = 30.0
    must_succeed: bool = False

    def arguments(self) -> list[str]:
        """Return pytest's arguments."""
        chosen = [f"--capability={self.capability}", f"--plugin={self.name}"]
        chosen += [f"--model={self.model}", f"--time-limit={self.time_limit_s}"]
        chosen += [f"--set={option}" for option in self.options]
        return chosen + (["--must-succeed"] if self.must_succeed else [])


def hold_to_contract(trial: Trial) -> tuple[Finding, ...]:
    """Run every check of a capability over one plugin.

    Raises:
        ConfigError: If there is no such plugin, it cannot be imported, or its settings are wrong.
    """
    capability = trial.capability
    if capability == LEAF:
        return _hold_leaf(trial)
    known = (*registry.capabilities(), registry.SMOOTHERS, LEAF)
    if capability not in known:
        raise ConfigError(f"no capability '{capability}'{did_you_mean(capability, known)}")
    plugin_class = registry.load(capability, trial.name)
    subject_of(capability, trial.name, trial.options, trial.model).machine  # noqa: B018 - checks
    names = ("contract", "settings", "lifecycle", "answers", capability)
    return _run(trial, plugin_class, names)


def _hold_leaf(trial: Trial) -> tuple[Finding, ...]:
    return _run(trial, registry.load(registry.BEHAVIOURS, trial.name), ("leaf",))


def _run(trial: Trial, under_test: type[Any], names: tuple[str, ...]) -> tuple[Finding, ...]:
    paths = [str(p) for name in names if (p := _SUITES / f"test_{name}.py").is_file()]
    collector, output = _Collector(under_test), io.StringIO()
    arguments = [*_QUIET, f"--rootdir={_SUITES}", *trial.arguments(), *paths]
    with _without_foreign_plugins(), contextlib.redirect_stderr(output):
        status = pytest.main(arguments, plugins=[collector])
    if status not in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED):
        raise ConfigError(f"the checks could not be run: {output.getvalue().strip() or status}")
    return tuple(collector.findings)


class _Collector:
    """Takes pytest's reports down as findings."""

    def __init__(self, plugin_class: type[Any]) -> None:
        self._class = plugin_class
        self.findings: list[Finding] = []

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(
        self, item: pytest.Item, call: pytest.CallInfo[None]
    ) -> Generator[None, pytest.TestReport, pytest.TestReport]:
        report = yield
        if report.when == "call" or not report.passed:
            self.findings.append(self._finding(item, call, report))
        return report

    def _finding(
        self, item: pytest.Item, call: pytest.CallInfo[None], report: pytest.TestReport
    ) -> Finding:
        check, error = words(item.name), call.excinfo
        if report.when == "teardown":
            check += " (at the end)"
        if report.passed or error is None:
            return Finding(check, Outcome.PASS, "", "", call.duration)
        if report.skipped:
            return Finding(check, Outcome.SKIP, _reason(error), "", call.duration)
        place = _place_within(self._class, error.tb) or _place_of_class(self._class)
        return Finding(check, Outcome.FAIL, _reason(error), place, call.duration)


def _place_within(plugin_class: type[Any], trace: TracebackType | None) -> str:
    """Return `file:line` of the innermost frame of the plugin's own package; empty if none."""
    package = plugin_class.__module__.partition(".")[0]
    names = [(one, str(one[0].f_globals.get("__name__"))) for one in traceback.walk_tb(trace)]
    own = [
        one
        for one, name in names
        if name.partition(".")[0] == package and not name.startswith("executive.testing")
    ]
    return place_of(own, plugin_class.__module__)


def _place_of_class(plugin_class: type[Any]) -> str:
    try:
        return f"{inspect.getsourcefile(plugin_class)}:{inspect.getsourcelines(plugin_class)[1]}"
    except (OSError, TypeError):
        return plugin_class.__module__


def _reason(error: pytest.ExceptionInfo[BaseException]) -> str:
    said = str(error.value).strip().splitlines()
    first = said[0].removeprefix("Skipped: ") if said else ""
    if isinstance(error.value, AssertionError | pytest.skip.Exception | pytest.fail.Exception):
        return first or "the check fails"
    return f"{error.typename}: {first}" if first else error.typename


@contextlib.contextmanager
def _without_foreign_plugins() -> Iterator[None]:
    """Keep pytest plugins of other packages out: their options and warnings are no part of this."""
    before = os.environ.get(_AUTOLOAD)
    os.environ[_AUTOLOAD] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ[_AUTOLOAD]
        else:
            os.environ[_AUTOLOAD] = before
