"""Marks the tests that `slow.txt` names, so that `make test-fast` can leave them out, and lets a
test that takes too much memory fail by itself."""

import resource
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SLOW = frozenset((Path(__file__).with_name("slow.txt")).read_text().split("\n"))

# Half more than the tests of one core take at most (6.8 GB). A test that goes beyond gets a
# MemoryError; the system would end one of the processes, and nobody would know for which test.
MOST_BYTES = 10 * 1024**3


def pytest_configure() -> None:
    """Bound the memory of this process."""
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (MOST_BYTES, hard))


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark them, whatever their parameters."""
    for item in items:
        name = f"{item.path.relative_to(ROOT).as_posix()}::{item.name.partition('[')[0]}"
        if name in SLOW:
            item.add_marker(pytest.mark.slow)
