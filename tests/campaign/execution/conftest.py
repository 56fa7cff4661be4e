"""A cluster of real processes on this computer, and work for it that its workers find installed."""

import importlib.util
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from executive import registry
from executive.campaign.execution.fingerprint import local_fingerprint
from executive.campaign.execution.pool import Lost, Pool
from executive.campaign.trial import Outcome, Trial

DEADLINE_S = 60.0


@pytest.fixture(scope="module")
def clusters() -> ModuleType:
    path = Path(__file__).parents[1] / "cluster.py"
    spec = importlib.util.spec_from_file_location("local_clusters", path)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def spread(clusters: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Install the work `spread` for this process, and return the folder for others."""
    folder = clusters.install_spread(tmp_path_factory.mktemp("installed"))
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(folder))
        _reread()
        yield folder
    _reread()


def _reread() -> None:
    """Forget what was installed."""
    registry.reread()
    local_fingerprint.cache_clear()


@pytest.fixture(scope="module")
def cluster(
    clusters: ModuleType, spread: Path, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Any]:
    """A scheduler with two workers."""
    made = clusters.Cluster(tmp_path_factory.mktemp("cluster"))
    try:
        for name in ("first", "second"):
            made.add_worker(name, [spread])
        yield made
    finally:
        made.stop()


@pytest.fixture
def finish() -> Callable[..., tuple[list[Outcome], list[Lost]]]:
    """Return what runs trials to their end as a campaign does: a lost one is begun again."""

    def run(
        pool: Pool,
        trials: Sequence[Trial],
        folder: Path,
        after: Callable[[int], None] = lambda ended: None,
    ) -> tuple[list[Outcome], list[Lost]]:
        waiting = [(trial, 1) for trial in trials]
        going: dict[int, tuple[Trial, int]] = {}
        outcomes: list[Outcome] = []
        losses: list[Lost] = []
        until = time.monotonic() + DEADLINE_S
        while waiting or going:
            assert time.monotonic() < until, f"{len(outcomes)} ended, {going} did not"
            while waiting and len(going) < pool.slots:
                trial, tries = waiting.pop(0)
                going[trial.number] = (trial, tries)
                pool.begin(trial, folder / f"{trial.number}-{tries}", tries)
            for end in pool.wait(0.5):
                trial, tries = going.pop(end.number)
                if isinstance(end, Lost):
                    losses.append(end)
                    waiting.append((trial, tries + 1))
                else:
                    outcomes.append(end)
                after(len(outcomes))
        return outcomes, losses

    return run
