"""The faulty plugins, installed for a test and for the processes that it starts."""

import importlib.util
import os
import sys
from pathlib import Path

import pytest

from executive import registry

_PACKAGE = Path(__file__).parent / "jobs" / "faulty" / "package.py"


def _install(folder: Path) -> None:
    spec = importlib.util.spec_from_file_location("faulty_package", _PACKAGE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.install(folder)


@pytest.fixture(scope="session")
def faulty_folder(tmp_path_factory):
    """The folder of the package, for the path of other processes."""
    folder = tmp_path_factory.mktemp("faulty")
    _install(folder)
    return folder


@pytest.fixture
def faulty(faulty_folder, monkeypatch):
    """The module of faulty plugins, registered under the name `faulty`."""
    monkeypatch.syspath_prepend(str(faulty_folder))
    monkeypatch.setenv("PYTHONPATH", str(faulty_folder), prepend=os.pathsep)
    registry.reread()
    import faulty_plugins

    yield faulty_plugins
    sys.modules.pop("faulty_plugins", None)
    registry.reread()
