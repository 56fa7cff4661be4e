"""A package on the path, as pip would install it, without pip."""

import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import pytest

from executive import registry

Install = Callable[[str, Mapping[str, str], Mapping[str, Mapping[str, str]]], Path]


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Install]:
    """Put files on the path, and announce their entry points by group and name."""
    packages: list[str] = []

    def put(
        package: str, files: Mapping[str, str], announced: Mapping[str, Mapping[str, str]]
    ) -> Path:
        folder = tmp_path / "site"
        for name, text in files.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8")
        info = folder / f"{package}-0.1.0.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 0.1.0\n")
        groups = (
            "\n".join([f"[executive.{group}.v1]", *(f"{n} = {v}" for n, v in points.items()), ""])
            for group, points in announced.items()
        )
        (info / "entry_points.txt").write_text("\n".join(groups))
        monkeypatch.syspath_prepend(str(folder))
        packages.append(package)
        registry.reread()
        return folder

    yield put
    for module in [m for m in sys.modules if m.partition(".")[0] in packages]:
        del sys.modules[module]
    monkeypatch.undo()
    registry.reread()
