"""`executive calibrate` and `compare-estimators` apart from what they ask for."""

import json
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import typer

from executive.commands.logs import calibrate as calibrate_verb
from executive.commands.logs import compare_estimators as compare_verb
from executive.errors import ConfigError


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """What the verbs hand on, and what is found."""
    told = SimpleNamespace(is_found=True, written=[], compared=[], recorded=[], extras=[])

    def options(*given: Any, **named: Any) -> Any:
        return given, named

    def compare(*given: Any) -> dict[str, int]:
        told.compared.append(given)
        return {"one": 1}

    def record(*given: Any) -> str:
        told.recorded.append(given)
        return "a recorded run"

    parts = {
        "estimate.options": {
            "log_choices": lambda wanted, **plugins: (wanted, plugins),
            "EstimateOptions": options,
        },
        "estimate.material": {"Material": SimpleNamespace(read=lambda *given: given)},
        "estimate.calibrate": {
            "calibrated": lambda material, name: (material, name),
            "lines": lambda quantities: ["a clock"],
            "write_calibration": lambda *given: told.written.append(given),
            "is_any_found": lambda quantities: told.is_found,
            "report": lambda *given: {"found": told.is_found},
        },
        "estimate.calibration": {"read_calibration": lambda path: f"what {path} says"},
        "estimate.compare": {"compare": compare, "table": lambda reports: f"table of {reports}"},
        "commands.logs.recorded_mission": {
            "is_mission": lambda name: not name.suffix,
            "record_mission": record,
            "compare_on": compare,
        },
    }
    for name, part in parts.items():  # whole modules, which take seconds to import
        monkeypatch.setitem(sys.modules, f"executive.{name}", SimpleNamespace(**part))
    for verb in (calibrate_verb, compare_verb):
        monkeypatch.setattr(verb, "require_extra", lambda *given: told.extras.append(given))
    return told


def test_a_calibration_is_told_written_and_said_how_to_use(
    asked: SimpleNamespace, tmp_path: Path, capsys: Any
) -> None:
    out = tmp_path / "rig.yaml"
    calibrate_verb.calibrate(Path("a.mcap"), out, ["imu=/imu"], "m545", None, True, ["a lever"])
    ((path, log, quantities),) = asked.written
    assert (path, log) == (out, Path("a.mcap"))
    (read_log, (given, named)), method = quantities
    assert (read_log, given, method) == (Path("a.mcap"), ("m545", ["imu=/imu"]), "keyframe_batch")
    assert set(named) == {"plugins", "levers"}
    assert named["levers"] == ["a lever"]
    assert asked.extras == [("executive calibrate", "logs")]
    told = capsys.readouterr()
    use = f"{out}: for executive estimate a.mcap --calibration {out}"
    assert told.err.splitlines() == ["a clock", use]
    assert json.loads(told.out) == {"found": True}


def test_that_nothing_was_found_is_status_1(
    asked: SimpleNamespace, tmp_path: Path, capsys: Any
) -> None:
    asked.is_found = False
    with pytest.raises(typer.Exit) as ended:
        calibrate_verb.calibrate(Path("a.mcap"), tmp_path / "rig.yml")
    assert ended.value.exit_code == 1
    told = capsys.readouterr()
    assert "no clock and no mounting was found: the motion does not show them" in told.err
    assert told.out == ""
    assert len(asked.written) == 1
    with pytest.raises(ConfigError, match=r"--out: .*rig\.json: name a \.yaml or \.yml file"):
        calibrate_verb.calibrate(Path("a.mcap"), tmp_path / "rig.json")


def test_estimators_are_compared_on_a_log(asked: SimpleNamespace, capsys: Any) -> None:
    compare_verb.compare_estimators(
        Path("a.mcap"), ["one", "two"], ["a drop"], ["an offset"], ["imu=/imu"], "m545", None,
        Path("rig.yaml"), 3, ["estimation.one.gate=30"], False,
    )  # fmt: skip
    (((log, (given, named)), names, options),) = asked.compared
    assert (log, names, options) == (Path("a.mcap"), ["one", "two"], (given, named))
    assert named == {"levers": ()}
    machine, topics, drops, offsets, known, (wanted, plugins) = given
    assert (machine, topics, drops, offsets) == ("m545", ["imu=/imu"], ["a drop"], ["an offset"])
    assert known == "what rig.yaml says"
    assert "estimation.one.gate=30" in wanted
    assert plugins["estimation"] == ["one", "two"]
    assert asked.recorded == []
    assert capsys.readouterr().out == "table of {'one': 1}\n"


def test_of_a_mission_the_settings_change_the_mission(asked: SimpleNamespace, capsys: Any) -> None:
    compare_verb.compare_estimators(Path("relocate"), set_=["a=1"], seed=3, as_json=True)
    ((mission, overrides, seed, folder),) = asked.recorded
    assert (mission, overrides, seed) == ("relocate", ["a=1"], 3)
    assert not folder.exists()  # it was there for the time of the run
    ((recorded, names, (given, _)),) = asked.compared
    assert recorded == "a recorded run"
    assert "dual_graph" in names  # all that are installed
    machine, topics, drops, offsets, known, (wanted, _) = given
    assert (machine, known) == (None, None)
    assert len(topics) == len(drops) == len(offsets) == 0
    assert "a=1" not in wanted
    assert json.loads(capsys.readouterr().out) == {"one": 1}
