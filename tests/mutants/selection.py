"""A pytest plugin that keeps the tests that the file `MUTANTS_SELECTION` names, one a line."""

import json
import os
from pathlib import Path

import pytest


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Drop all other tests."""
    wanted = set(json.loads(Path(os.environ["MUTANTS_SELECTION"]).read_text(encoding="utf-8")))
    config.hook.pytest_deselected(items=[one for one in items if one.nodeid not in wanted])
    items[:] = [one for one in items if one.nodeid in wanted]
