"""What a run recorded, for the verbs of logs, and bulk work over many inputs."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from executive.commands import bulk
from executive.commands.logs import recorded_mission


def test_the_truth_is_that_of_the_oracle() -> None:
    seen: list[Any] = []

    def truth(view: Any) -> Any:
        seen.append(view)
        return SimpleNamespace(estimate={"position_m": {"rms": 0.25}})

    recorded = recorded_mission.RecordedMission(Path("a"), SimpleNamespace(truth=truth), None)
    assert recorded.truth(["a state"]) == {"position_m": {"rms": 0.25}}
    (view,) = seen
    assert (view.states, view.stones, view.slots, view.attempts) == (["a state"], (), {}, ())


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """A mission that ticks twice; `robots` have an oracle each."""
    made = SimpleNamespace(robots=["kinematic"], oracles=[])
    settings = SimpleNamespace(datum=(47.0, 8.0, 440.0))
    plugins = {
        "robot": [SimpleNamespace(name="kinematic")],
        "estimation": [SimpleNamespace(settings=settings)],
    }
    made.description = SimpleNamespace(plugins=plugins)

    class Run:
        def __init__(self, description: Any, options: Any) -> None:
            made.options = options

        def execute(self, watch: Any) -> None:
            services = SimpleNamespace(plugins={"robot": "the robot"})
            for _ in range(2):
                watch(SimpleNamespace(services=services))

    def oracle(robot: str) -> str:
        made.oracles.append(robot)
        return f"oracle of {robot}"

    def load(mission: str, overrides: list[str]) -> Any:
        made.loaded = mission, overrides
        return made.description

    monkeypatch.setattr(recorded_mission, "Run", Run)
    monkeypatch.setattr(recorded_mission, "load_mission", load)
    monkeypatch.setattr(recorded_mission.registry, "names", lambda group: made.robots)
    monkeypatch.setattr(recorded_mission.registry, "load", lambda group, name: oracle)
    return made


def test_a_mission_is_recorded_with_its_oracle_and_the_origin_of_its_map(
    run: SimpleNamespace, tmp_path: Path
) -> None:
    found = recorded_mission.record_mission("relocate", ("a=1",), 4, tmp_path)
    assert run.loaded == ("relocate", ["a=1"])
    assert (run.options.seed, run.options.run_dir) == (4, tmp_path / "run")
    assert found.log == run.options.record_log == tmp_path / "recorded.mcap"
    assert (found.oracle, found.datum) == ("oracle of the robot", (47.0, 8.0, 440.0))
    assert run.oracles == ["the robot"]  # made once
    run.robots = []
    run.description.plugins["estimation"] = [SimpleNamespace(settings=object())]
    found = recorded_mission.record_mission("relocate", (), 4, tmp_path)
    assert (found.oracle, found.datum) == (None, None)


@pytest.mark.parametrize("has_oracle", [True, False])
@pytest.mark.parametrize("datum", [None, (47.0, 8.0, 440.0)])
def test_estimators_are_compared_from_the_origin_of_the_map(
    monkeypatch: pytest.MonkeyPatch, datum: Any, has_oracle: bool
) -> None:
    from dataclasses import dataclass

    @dataclass
    class Material:
        datum: Any

        @classmethod
        def read(cls, log: Path, options: Any) -> "Material":
            assert (log, options) == (Path("a.mcap"), "options")
            return cls(np.array([1.0, 2.0, 3.0]))

    compared: list[Any] = []

    def compare(*given: Any) -> str:
        compared.append(given)
        return "reports"

    monkeypatch.setattr(recorded_mission, "Material", Material)
    monkeypatch.setattr(recorded_mission, "compare", compare)
    oracle = SimpleNamespace() if has_oracle else None
    recorded = recorded_mission.RecordedMission(Path("a.mcap"), oracle, datum)
    assert recorded_mission.compare_on(recorded, ["one"], "options") == "reports"
    ((material, names, options, truth),) = compared
    assert material.datum.tolist() == list(datum or (1.0, 2.0, 3.0))
    assert (names, options) == (["one"], "options")
    assert truth == (recorded.truth if has_oracle else None)


@pytest.mark.parametrize(
    ("failing", "stopped", "status"), [([], "", 0), ([2], "", 1), ([], "Ctrl-C", 1)]
)
def test_bulk_work_hands_over_what_is_done_and_tells_what_failed(
    monkeypatch: pytest.MonkeyPatch, capsys: Any, failing: list[int], stopped: str, status: int
) -> None:
    from executive.campaign.trial import Outcome, Status

    asked: list[Any] = []

    def run(work: Any, scratch: Path, pool: Any, take: Any) -> Any:
        asked.append((work.work, dict(work.arguments), list(work.seeds), scratch, pool))
        for seed in work.seeds:
            is_bad = seed in failing
            state = Status.CRASHED if is_bad else Status.DONE
            outcome = Outcome(0, state, reason="torn" if is_bad else "")
            take(SimpleNamespace(seed=seed, folder=Path(str(seed)), outcome=outcome))
        return SimpleNamespace(stopped_by=stopped)

    monkeypatch.setattr("executive.campaign.bulk.run_bulk", run)
    monkeypatch.setattr(bulk, "pool_of", lambda *given: given)
    taken: list[Any] = []
    where = bulk.Where(Path("scratch"), jobs=3)
    told = bulk.spread("spread", {"a": 1}, [1, 2], where, lambda *given: taken.append(given))
    assert told == status
    assert asked == [("spread", {"a": 1}, [1, 2], Path("scratch"), (3, None))]
    assert taken == [(seed, Path(str(seed))) for seed in (1, 2) if seed not in failing]
    said = capsys.readouterr().err
    assert ("\nspread, seed 2: crashed: torn" in said) is bool(failing)
    assert ("\nstopped by Ctrl-C; the same command goes on" in said) is bool(stopped)
    cluster = bulk.Where(Path("scratch"), jobs=3, scheduler="tcp://s")
    bulk.spread("spread", {}, [], cluster, lambda *given: None)
    assert asked[-1][-1] == (None, "tcp://s")
