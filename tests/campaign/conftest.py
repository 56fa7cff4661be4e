"""A kind of work that is installed for tests, in processes too, and what trials are made of."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from executive import registry
from executive.campaign.execution.fingerprint import local_fingerprint
from executive.campaign.trial import Limits, Trial

GIBIBYTE = 1 << 30


@pytest.fixture
def misbehaving(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Install the work `misbehaving` where this process and its children look."""
    folder = tmp_path / "installed"
    info = folder / "misbehaving.egg-info"
    info.mkdir(parents=True)
    source = Path(__file__).with_name("misbehaving.py")
    (folder / "misbehaving.py").write_text(source.read_text())
    (info / "PKG-INFO").write_text("Metadata-Version: 2.1\nName: misbehaving\nVersion: 0.1\n")
    (info / "entry_points.txt").write_text(
        "[executive.work.v1]\nmisbehaving = misbehaving:Misbehaving\n"
    )
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("PYTHONPATH", str(folder), prepend=":")
    _reread()
    yield
    monkeypatch.undo()
    _reread()


def _reread() -> None:
    """Forget what was installed."""
    registry.reread()
    local_fingerprint.cache_clear()


@pytest.fixture
def trial() -> Callable[..., Trial]:
    """Return what makes a trial of the work `misbehaving`."""

    def make(
        behaviour: str = "answer",
        number: int = 0,
        time_s: float = 30.0,
        memory_bytes: int = GIBIBYTE,
        **arguments: Any,
    ) -> Trial:
        return Trial(
            number,
            "misbehaving",
            {"behaviour": behaviour, **arguments},
            seed=number + 1,
            levels={},
            limits=Limits(time_s, memory_bytes),
        )

    return make
