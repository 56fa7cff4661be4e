"""What the tests of reports share: a made-up campaign and its report."""

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture(scope="session")
def made_up() -> ModuleType:
    """Return the module of made-up campaigns."""
    path = Path(__file__).with_name("made_up.py")
    spec = importlib.util.spec_from_file_location("made_up_campaigns", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
