"""Marks the tests that `slow.txt` names, so that `make test-fast` can leave them out, hands the
slowest files to the cores first, lets a test that takes too much memory fail by itself, and none
for the time that a case of Hypothesis takes."""

import resource
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# How long a case takes tells of the computer and of what else runs on it.
settings.register_profile(
    "any computer", deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("any computer")

ROOT = Path(__file__).parents[1]
SLOW = frozenset((Path(__file__).with_name("slow.txt")).read_text().split("\n"))

APART = ROOT / "tests" / "testing" / "test_clean_environment.py"

# Half more than the tests of one core take at most (6.8 GB). A test that goes beyond gets a
# MemoryError; the system would end one of the processes, and nobody would know for which test.
MOST_BYTES = 10 * 1024**3


def pytest_configure() -> None:
    """Bound the memory of this process."""
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (MOST_BYTES, hard))


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark slow ones, whatever their parameters; order them for several cores."""
    for item in items:
        name = f"{item.path.relative_to(ROOT).as_posix()}::{item.name.partition('[')[0]}"
        if name in SLOW:
            item.add_marker(pytest.mark.slow)
    if items and hasattr(config, "workerinput"):  # of several cores, with `--no-loadscope-reorder`
        # What takes long begins early, so that at the end no core waits for a mission of another.
        missions, slow = (
            Counter(item.path for item in items if item.get_closest_marker(mark))
            for mark in ("mission", "slow")
        )
        items.sort(key=lambda one: (missions[one.path], slow[one.path]), reverse=True)
        # The first mission compiles for minutes. A second core that began with another would
        # compile the same at the same time; an environment of its own has to be compiled anyway.
        first = items[0].path
        items.sort(key=lambda one: (one.path != first, one.path != APART))
