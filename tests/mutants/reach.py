"""A pytest plugin that records which lines of the product each test reaches, and how long it takes.

It is loaded by `-p reach` in every process of pytest, and writes one file a process into the
folder that `MUTANTS_REACH` names. Tests that fail are left out: they can judge nothing. What is
reached in a process that a test starts, and inside compiled functions, is not seen.
"""

import json
import os
import time
from collections import defaultdict
from collections.abc import Generator
from pathlib import Path

import coverage
import pytest

FOLDER = Path(os.environ["MUTANTS_REACH"])
MEASURED = ("executive", "plugins")


class Recorder:
    """Measures the lines that each test reaches, with what is set up for it."""

    def __init__(self, root: Path) -> None:
        self._root = root
        include = [str(root / folder / "*") for folder in MEASURED]
        self._measured = coverage.Coverage(data_file=None, config_file=False, include=include)
        self._measured.start()
        self._seconds: dict[str, float] = {}
        self._failed: set[str] = set()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Generator[None, object, object]:
        self._measured.switch_context(item.nodeid)
        begun_s = time.process_time()
        answer = yield
        self._seconds[item.nodeid] = round(time.process_time() - begun_s, 3)
        self._measured.switch_context("")
        return answer

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if not report.passed:
            self._failed.add(report.nodeid)

    def pytest_sessionfinish(self) -> None:
        self._measured.stop()
        data = self._measured.get_data()
        bits: dict[str, dict[str, int]] = defaultdict(lambda: defaultdict(int))
        for file in data.measured_files():
            name = Path(file).resolve().relative_to(self._root).as_posix()
            for line, tests in data.contexts_by_lineno(file).items():
                for test in tests:
                    bits[test][name] |= 1 << line
        answer = {
            test: {"seconds": seconds, "reached": {f: f"{b:x}" for f, b in bits[test].items()}}
            for test, seconds in self._seconds.items()
            if test not in self._failed
        }
        (FOLDER / f"{os.getpid()}.json").write_text(json.dumps(answer), encoding="utf-8")


def pytest_configure(config: pytest.Config) -> None:
    """Start to measure, but not in the process that only hands tests out."""
    if not getattr(config.option, "numprocesses", None) or hasattr(config, "workerinput"):
        config.pluginmanager.register(Recorder(config.rootpath.resolve()))
