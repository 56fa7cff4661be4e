"""One run of the kit over one plugin: pytest within this process, its outcome as findings."""

import contextlib
import inspect
import io
import os
import traceback
from collections.abc import Generator, Iterator, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import pytest

from executive.errors import ConfigError
from executive.mission.fault import place_of
from executive.testing import suites
from executive.testing.finding import Finding, Outcome, words

_SUITES = Path(suites.__file__).parent
_OF_ALL = ("contract", "settings", "lifecycle", "answers")
_QUIET = ("-p", "no:cacheprovider", "-p", "no:terminal", "--capture=no", "-c", os.devnull)
_AUTOLOAD = "PYTEST_DISABLE_PLUGIN_AUTOLOAD"


def hold_to_contract(
    capability: str, plugin_class: type[Any], options: Sequence[str]
) -> tuple[Finding, ...]:
    """Run every check of a capability over one plugin.

    Args:
        capability: Its capability.
        plugin_class: Its class, whose file a failure names.
        options: pytest's and the kit's own options, see `executive.testing.pytest_plugin`.

    Raises:
        ConfigError: If pytest cannot run the checks with these options.
    """
    own = _SUITES / f"test_{capability}.py"
    files = [_SUITES / f"test_{name}.py" for name in _OF_ALL]
    paths = [str(path) for path in (*files, own) if path.is_file()]
    collector = _Collector(plugin_class)
    arguments = [*_QUIET, f"--rootdir={_SUITES}", "--import-mode=importlib", *options, *paths]
    output = io.StringIO()
    with _without_foreign_plugins(), contextlib.redirect_stderr(output):
        status = pytest.main(
            ["-p", "executive.testing.pytest_plugin", *arguments], plugins=[collector]
        )
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
