"""`executive estimate` does what its options ask for, over an estimator that is made up."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from executive.commands.logs import estimate as verb
from executive.errors import ConfigError
from executive.estimate import (
    calibration,
    estimator_run,
    files,
    material,
    odometry_file,
    reference,
    score,
    trajectory,
)

LOG = Path("run.mcap")


@pytest.fixture
def ran(monkeypatch: pytest.MonkeyPatch):
    """Return what runs the verb, and gives what was called and said."""

    def run(**options: Any) -> SimpleNamespace:
        told = SimpleNamespace(calls=[], said=[], answered=[], options=None)

        def called(name: str, given: Any):
            return lambda *args, **_: told.calls.append((name, *args[2:])) or given

        found = SimpleNamespace(
            track=SimpleNamespace(stamps_s=np.arange(7.0)), report={"score": "exact"}
        )

        def read(log: Path, options: Any) -> str:
            told.options = options
            return "material"

        monkeypatch.setattr(verb, "require_extra", lambda *_: None)
        monkeypatch.setattr(verb, "say", told.said.append)
        monkeypatch.setattr(verb, "answer", told.answered.append)
        monkeypatch.setattr(material.Material, "read", read)
        monkeypatch.setattr(estimator_run, "estimate", lambda *args: found)
        monkeypatch.setattr(reference, "with_reference", called("reference", found))
        monkeypatch.setattr(score, "with_score", called("score", found))
        monkeypatch.setattr(score, "summary", lambda one: f"summary of {one}")
        monkeypatch.setattr(trajectory, "read_trajectory", lambda path, topic: (path, topic))
        monkeypatch.setattr(calibration, "read_calibration", lambda path: f"from {path}")
        monkeypatch.setattr(files, "write_files", called("write", ("a.tum", "a.json")))
        monkeypatch.setattr(odometry_file, "check_format", lambda path: None)
        verb.estimate(LOG, out=Path("a.tum"), **options)
        return told

    return run


def test_a_log_is_estimated_and_written(ran) -> None:
    told = ran()
    assert [name for name, *_ in told.calls] == ["write"]
    (said,) = told.said
    assert said.endswith(" on run.mcap: 7 states, a.tum, a.json")
    assert told.answered == []
    assert not told.options.is_realtime


def test_a_score_is_made_and_said(ran) -> None:
    told = ran(score=Path("truth.tum"), align="yaw", score_topic="/truth")
    assert told.calls[0] == ("score", (Path("truth.tum"), "/truth"), "yaw")
    assert told.said[1:] == ["summary of exact"]


def test_a_batch_an_answer_and_exports_are_asked_for(ran) -> None:
    told = ran(batch=True, as_json=True, export=[Path("b.csv")], realtime=True)
    assert told.calls[0] == ("reference", "batch_graph")
    assert told.calls[1][-1] == [Path("b.csv")]
    assert told.answered == [{"score": "exact"}]
    assert told.options.is_realtime


def test_an_unknown_alignment_is_refused(ran) -> None:
    with pytest.raises(ConfigError, match="--align"):
        ran(align="yawn")
