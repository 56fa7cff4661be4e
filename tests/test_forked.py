"""Work of a benchmark that continues from one state in processes of its own."""

import importlib
import os
from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture
def forked(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(Path(__file__).parent / "benchmarks"))
    return importlib.import_module("forked")


@pytest.mark.parametrize("jobs", [1, 3])
def test_each_item_continues_from_the_same_state_in_order(forked, jobs: int) -> None:
    state = [1]

    def work(item: int) -> int:
        state.append(item)
        return sum(state)

    assert list(forked.forked(work, range(5), jobs)) == [1, 2, 3, 4, 5]
    assert state == [1]


def test_a_process_without_a_result_is_an_error(forked) -> None:
    def work(item: int) -> None:
        os._exit(item)

    with pytest.raises(RuntimeError, match="without a result"):
        list(forked.forked(work, [3], 1))
