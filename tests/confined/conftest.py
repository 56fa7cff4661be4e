"""A file to be read."""

from pathlib import Path

import pytest


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "given.bin"
    path.write_bytes(b"content")
    return path
