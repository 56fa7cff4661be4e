"""A pytest plugin that collects the tests once, and runs some of them in forks of this process.

So a fault costs what its tests cost, not the imports. It is planted in the code of functions that
are loaded already; its file holds it, too, for what is imported later and for other processes.
What cannot be planted so is refused: a change of what is done at the import, of a function that was
called then, of a compiled function, or of the number of variables that a function shares.

A run that it refuses ends with the status `REFUSED`.
"""

import gc
import inspect
import os
import sys
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import CodeType, FrameType, FunctionType
from typing import Any

import pytest

from mutants.forks import REFUSED, asked_of_a_fork

FOLDERS = ("executive", "plugins")


class RefusedError(Exception):
    """A fault that cannot be planted in what is loaded."""


class Collected:
    """The tests, and the functions of the product that they have loaded."""

    def __init__(self) -> None:
        root = Path.cwd()
        self._folders = tuple(f"{(root / folder).resolve()}{os.sep}" for folder in FOLDERS)
        self._called: set[tuple[str, str, int]] = set()
        self._codes: dict[int, CodeType] = {}  # by identity: to hash a code is slow
        self._failed = ""
        sys.settrace(self._note)

    def _note(self, frame: FrameType, event: str, _: object) -> None:
        """Note a function that is called while the tests are collected; its lines are not asked."""
        self._codes[id(frame.f_code)] = frame.f_code

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Serve in place of running all tests; a fork runs those that it was asked for."""
        sys.settrace(None)
        for code in self._codes.values():
            if _real(code.co_filename).startswith(self._folders):
                self._called.add(_place(code))
        items = {item.nodeid: item for item in session.items}
        functions: dict[str, list[FunctionType]] = defaultdict(list)
        for one in gc.get_objects():
            if type(one) is FunctionType:
                functions[_real(one.__code__.co_filename)].append(one)
        gc.freeze()
        wanted = asked_of_a_fork()
        if wanted is None:
            return True
        if not items.keys() >= set(wanted["names"]):
            os._exit(REFUSED)
        if wanted["file"]:
            path = Path(wanted["file"]).resolve()
            try:
                self._plant(path, wanted["before"], functions[str(path)])
            except RefusedError:
                os._exit(REFUSED)
        self._run(session, [items[name] for name in wanted["names"]])
        if self._failed:
            Path(wanted["output"]).write_text(f"{self._failed}\n", encoding="utf-8")
        return True

    def _run(self, session: pytest.Session, items: list[pytest.Item]) -> None:
        """Run tests up to the first that fails."""
        session.testsfailed = 0
        for item, following in zip(items, [*items[1:], None], strict=True):
            item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
            if self._failed:
                return

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed and not self._failed:
            self._failed = f"{'FAILED' if report.when == 'call' else 'ERROR'} {report.nodeid}"

    def _plant(self, path: Path, before: str, functions: list[FunctionType]) -> None:
        """Give the loaded functions of a file the code that the file now holds."""
        if "njit" in before:
            raise RefusedError
        if not functions and not _is_imported(path):
            return
        new = {}
        sources = before, path.read_bytes()
        for old, changed in _pairs(
            *(compile(s, str(path), "exec", dont_inherit=True) for s in sources)
        ):
            is_function = bool(old.co_flags & inspect.CO_OPTIMIZED)
            if _own(old) != _own(changed) and (not is_function or _place(old) in self._called):
                raise RefusedError
            new[_place(old)] = changed
        for function in functions:
            changed = new.get(_place(function.__code__), function.__code__)
            if len(changed.co_freevars) != len(function.__code__.co_freevars):
                raise RefusedError
            function.__code__ = changed


_real = cache(os.path.realpath)  # of few files, for many functions


def _is_imported(path: Path) -> bool:
    files = [getattr(module, "__file__", None) for module in [*sys.modules.values()]]
    return str(path) in {os.path.realpath(file) for file in files if file}


def _place(code: CodeType) -> tuple[str, str, int]:
    """Return where a function is: lambdas of one line are told apart by their column."""
    column = next((one[2] for one in code.co_positions() if one[2]), 0)
    return code.co_qualname, os.path.basename(code.co_filename), code.co_firstlineno * 1000 + column


def _pairs(old: CodeType, new: CodeType) -> Iterator[tuple[CodeType, CodeType]]:
    """Yield the code of each function, class and module before and after."""
    inner = [[one for one in code.co_consts if isinstance(one, CodeType)] for code in (old, new)]
    if old.co_name != new.co_name or len(inner[0]) != len(inner[1]):
        raise RefusedError
    yield old, new
    for one, other in zip(*inner, strict=True):
        yield from _pairs(one, other)


def _own(code: CodeType) -> tuple[Any, ...]:
    """Return what a function does itself, without the functions within it."""
    constants = [(type(one), one) for one in code.co_consts if not isinstance(one, CodeType)]
    names = code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars
    return code.co_code, repr(constants), code.co_exceptiontable, code.co_flags, names


def pytest_configure(config: pytest.Config) -> None:
    """Begin to note what is called."""
    config.pluginmanager.register(Collected())
