"""The modules beside these tests: they are commands, too."""

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

HERE = str(Path(__file__).parent)


@pytest.fixture(scope="session")
def modules() -> Iterator[dict[str, ModuleType]]:
    """Return the modules by name."""
    sys.path.insert(0, HERE)
    try:
        names = ("ours", "real", "cases", "random_trees", "compare", "accepted")
        yield {name: importlib.import_module(name) for name in names}
    finally:
        sys.path.remove(HERE)
