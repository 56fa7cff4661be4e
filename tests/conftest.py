"""Marks the tests that `slow.txt` names, so that `make test-fast` can leave them out."""

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SLOW = frozenset((Path(__file__).with_name("slow.txt")).read_text().split("\n"))


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark them, whatever their parameters."""
    for item in items:
        name = f"{item.path.relative_to(ROOT).as_posix()}::{item.name.partition('[')[0]}"
        if name in SLOW:
            item.add_marker(pytest.mark.slow)
