"""The report of a run is written and read as a class; what is no such report is refused."""

import copy
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args, get_type_hints

import numpy as np
import pytest

from executive.errors import DataError
from executive.events.mission import Fault
from executive.interfaces.report import CutOffReport, MissionEnding, MissionReport
from executive.interfaces.report_file import (
    REPORT,
    ending_in,
    read_ending,
    read_report,
    write_report,
)
from executive.interfaces.truth import Nothing, Truth
from executive.testing.blank import blank

POSE = np.eye(4).tolist()
FAULT = {
    "component": "motion plugin 'mine'",
    "capability": "motion",
    "name": "mine",
    "verb": "move",
    "node": "main/0:Move",
    "error": "KeyError: 'x'",
    "place": "mine.py:3",
    "traceback": "Traceback …",
}
STATISTICS = {"mean": 0.02, "std": 0.01, "max": 0.07}
TRUTH = {
    "scenario": "nominal",
    "stance": {"most_tilt_rad": 0.01, "least_margin_m": 0.8},
    "stones": [
        {
            "id": 1,
            "held_object": None,
            "slot_error_m": 0.05,
            "database_error_m": None,
            "database_error_rad": None,
            "models": 0,
            "volume_m3": 0.4,
            "centre_m": [5.0, 1.0, 0.3],
            "outline_m": [[4.5, 0.5], [5.5, 0.5], [5.0, 1.5]],
            "bottom_m": 0.0,
            "top_m": 0.6,
            "touches": ["stone_2", "terrain"],
        }
    ],
    "grasps": [{"object": 1, "lifted": True, "dropped": False}],
    "collisions": [
        {"bodies": ["boom", "stone_1"], "from_s": 1.0, "to_s": 1.5, "max_force_n": 900.0}
    ],
    "ground_contacts": 2,
    "estimate": {
        "error_m": {**STATISTICS, "bias": 0.01, "component_std": 0.005},
        "error_rad": STATISTICS,
    },
    "objects": {"stones": 2, "known": 1, "twice": 0, "ghosts": 0},
    "realignments": [
        {
            "stone": 1,
            "round": 1,
            "was_realigned": True,
            "settled_error_m": 0.05,
            "settled_error_rad": 0.02,
            "error_m": 0.01,
            "error_rad": 0.01,
        }
    ],
    "map": {"distance_m": {"median": 0.01, "p95": 0.05}, "bias_m": 0.001, "std_m": 0.01},
    "registration": {"error_m": 0.02, "error_rad": 0.001},
    "limits": [
        {
            "kind": "speed",
            "of": "J_BOOM",
            "largest_share": 0.91,
            "at_s": 31.2,
            "times_beyond": 0,
            "beyond_s": 0.0,
        }
    ],
    "structures": [
        {
            "name": "wall",
            "stones": [1, 2],
            "T_map_stones": [POSE, POSE],
            "moved_m": [0.01],
            "verdict": {"fill": 0.3, "running_joints": None},
        }
    ],
}
COUNTS = (
    "picks", "placed", "attempts", "first_attempt", "slips", "drops", "empty", "set_aside", "known",
    "untouched", "off", "unverified", "turn_unknown", "unseen", "lost", "corrected",
    "registrations", "registrations_accepted", "scans", "not_retried", "plugin_failures",
)  # fmt: skip
# The content of a file with every field, in the order in which runs have always written them.
WHOLE: dict[str, Any] = {
    "mission": "pick_and_place",
    "seed": 3,
    "outcome": "fault",
    "reason": "motion plugin 'mine' failed in 'move'",
    "fault": FAULT,
    "started_s": 0.0,
    "ended_s": 125.5,
    "wall_s": 31.25,
    "real_time_factor": 4.016,
    "picks": [
        {
            "object": 1,
            "attempts": [
                {
                    "grasp": {
                        "T_map_gripper": POSE,
                        "opening_m": 0.8,
                        "score": 0.9,
                        "costs": {"distance": 0.1},
                    },
                    "outcome": "placed",
                    "reason": "",
                    "started_s": 10.0,
                    "ended_s": 60.0,
                    "success": 0.87,
                }
            ],
            "placed": True,
            "unverified": False,
            "slot": 4,
            "planned_pose": POSE,
            "estimated_pose": POSE,
            "set_aside": None,
            "seen": "placed",
            "off_m": 0.02,
            "tilt_rad": 0.01,
            "turn_known": True,
            "mass_kg": 400.1,
            "mass_std_kg": 10.2,
        }
    ],
    "plugins": {"motion": ["mine"], "monitoring": ["one", "other"]},
    "counts": {name: number for number, name in enumerate(COUNTS)},
    "figures": {"depth": {"value": 1.5, "unit": "m"}},
    "marks": [
        {
            "time_s": 3.5,
            "text": "here",
            "kind_of_place": "stone",
            "position_map": [1.0, 2.0, 0.0],
            "stone": 1,
            "region": "",
        }
    ],
    "stones": [
        {
            "id": 1,
            "state": "placed",
            "centroid_map": [5.0, 1.0, 0.3],
            "extents_m": [1.0, 0.8, 0.6],
            "points": 500,
            "volume_m3": None,
        }
    ],
    "maps": [
        {
            "file": "site.ply",
            "points": 1000,
            "frame": "map",
            "T_map_base": POSE,
            "datum": [47.4084, 8.5106, 440.0],
        }
    ],
    "structures": [
        {
            "structure": "wall",
            "reason": "complete",
            "detail": "all",
            "standing": [1, 2],
            "refused": {"too_low": 3},
            "by_stone": {"4": {"too_low": 3}},
            "shape": {
                "name": "wall",
                "line": [[0.0, 5.0], [6.0, 5.0]],
                "thickness_m": 1.3,
                "height_m": 1.5,
                "batter_rad": 0.05,
                "faces": 2,
            },
        }
    ],
    "ignored_observations": {"Strange": 7},
    "refused_observations": {"imu: too fast": 2},
    "missing_samples": {"gnss_left": 12},
    "scans_not_fused": 3,
    "stale_states": 4,
    "faults": [
        {
            "number": 1,
            "target": "gnss",
            "how": "silent",
            "spans": [{"from_s": 1.0, "to_s": 2.0}, {"from_s": 3.0, "to_s": None}],
            "acted": 5,
        }
    ],
    "pauses": {"count": 1, "machine_s": 2.5, "wall_s": 2.6},
    "late_ticks": {
        "count": 1,
        "worst_s": 0.02,
        "limit": 5,
        "worst_cause": "mapping.add_scan_pair",
        "causes": {"mapping.add_scan_pair": 1},
    },
    "resources": {"cpu_s": 40.5, "peak_memory_bytes": 300000000, "compiling_s": 12.5},
    "timings_ms": {"motion.move": {"median": 20.5, "p95": 35.0, "n": 12}},
    "truth": TRUTH,
}
CUT_OFF = {"mission": "m", "outcome": "fault", "reason": "killed", "fault": FAULT}


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / REPORT


def put(path: Path, content: object) -> Path:
    path.write_text(json.dumps(content), encoding="utf-8")
    return path


def test_a_report_with_every_field_is_written_as_it_was_read(path: Path) -> None:
    report = read_report(put(path, WHOLE))
    assert isinstance(report, MissionReport)
    written = path.with_name("again.json")
    write_report(written, report)
    again = json.loads(written.read_text(encoding="utf-8"))
    assert again == WHOLE
    assert list(again) == list(WHOLE)
    assert sorted(one.name for one in path.parent.iterdir()) == ["again.json", REPORT]
    assert set(get_type_hints(MissionReport)) == set(WHOLE)  # the example leaves nothing out
    assert set(get_type_hints(Truth)) == set(TRUTH)


def test_what_was_read_has_types(path: Path) -> None:
    report = read_report(put(path, WHOLE))
    assert isinstance(report, MissionReport)
    assert report.picks[0].attempts[0].grasp.opening_m == 0.8
    assert report.picks[0].planned_pose is not None
    assert report.picks[0].planned_pose.shape == (4, 4)
    assert report.structures[0].standing == (1, 2)
    assert report.truth is not None
    assert report.truth.map
    assert report.truth.map.distance_m.median == 0.01
    assert report.truth.stones[0].outline_m.shape == (3, 2)


def test_fields_that_tell_nothing_are_left_out_and_may_be_absent(path: Path) -> None:
    written = blank(MissionReport, truth=blank(Truth)).payload()
    optional = ("refused_observations", "missing_samples", "scans_not_fused", "stale_states")
    assert not {*optional, "faults", "pauses", "late_ticks"} & written.keys()
    assert written["fault"] is None
    assert written["picks"] == []
    truth: Any = written["truth"]
    nothing = ("stance", "estimate", "objects", "map", "registration")
    assert [truth[name] for name in nothing] == [{}] * len(nothing)
    del written["truth"]
    found = read_report(put(path, written))
    assert isinstance(found, MissionReport)
    assert (found.truth, found.pauses, found.faults) == (None, None, ())
    truth["stance"] = {}
    found = read_report(put(path, {**written, "truth": truth}))
    assert isinstance(found, MissionReport)
    assert found.truth is not None
    assert isinstance(found.truth.stance, Nothing)
    assert not found.truth.stance


def test_the_report_of_a_run_that_was_cut_off_is_another_one(path: Path) -> None:
    report = read_report(put(path, CUT_OFF))
    assert isinstance(report, CutOffReport)
    assert isinstance(report.fault, Fault)
    assert report.payload() == CUT_OFF


def places(value: object, at: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Yield the path to each field of the example that must be there."""
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from places(inner, (*at, name))
            yield (*at, name)
    elif isinstance(value, list) and value:
        yield from places(value[0], (*at, 0))


# What may be absent: an entry of a mapping whose names the mission chooses, a field with a default,
# and the one field of the map's errors, which are then nothing.
FREE = (
    "plugins", "figures", "timings_ms", "costs", "refused", "ignored_observations", "causes",
    "verdict",
)  # fmt: skip
OPTIONAL = {
    "refused_observations", "missing_samples", "scans_not_fused", "stale_states", "faults",
    "pauses", "late_ticks", "truth", "volume_m3", "worst_cause", "causes", "datum", "success",
    "compiling_s", "shape", "batter_rad", "faces", "verdict",
}  # fmt: skip
NEEDED = [
    at
    for at in places(WHOLE)
    if (at[-1] not in OPTIONAL or at[:2] == ("truth", "stones"))
    and (len(at) < 2 or at[-2] not in (*FREE, "refused_observations", "missing_samples"))
    and at not in (("truth", "map", "distance_m"), ("truth", "structures"))
    and "by_stone" not in at
]


@pytest.mark.parametrize("at", NEEDED, ids=lambda at: ".".join(map(str, at)))
def test_a_field_that_is_missing_is_named_with_its_file_and_a_cure(
    path: Path, at: tuple[Any, ...]
) -> None:
    damaged = copy.deepcopy(WHOLE)
    inner: Any = damaged
    for step in at[:-1]:
        inner = inner[step]
    del inner[at[-1]]
    with pytest.raises(DataError) as refused:
        read_report(put(path, damaged))
    told = str(refused.value)
    assert told.startswith(f"{path}: not a report of this version of the executive: ")
    assert f"lacks its field '{at[-1]}'" in told
    assert all(f"'{step}'" in told or f"[{step}]" in told for step in at)
    assert "run the mission again" in told


def changed(**values: object) -> dict[str, object]:
    return {**copy.deepcopy(WHOLE), **values}


def of_pick(**values: object) -> dict[str, object]:
    return changed(picks=[{**copy.deepcopy(WHOLE["picks"][0]), **values}])


def of_truth(**values: object) -> dict[str, object]:
    return changed(truth={**copy.deepcopy(TRUTH), **values})


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (changed(sede=3), "the report has no field 'sede'"),
        (changed(seed="3"), "field 'seed': expected int, got '3'"),
        (changed(seed=True), "field 'seed': expected int, got True"),
        (changed(seed=None), "field 'seed': expected int, got None"),
        (changed(outcome="won"), "field 'outcome': expected one of success, failure, stopped"),
        (changed(outcome=["success"]), "field 'outcome': expected one of success"),
        (changed(fault="no"), "field 'fault': expected a mapping, got 'no'"),
        (changed(wall_s="long"), "field 'wall_s': expected float, got 'long'"),
        (changed(picks={}), "field 'picks': expected a list, got {}"),
        (changed(plugins=["motion"]), "field 'plugins': expected a mapping"),
        (changed(plugins={"motion": "mine"}), "field 'plugins', 'motion': expected a list"),
        (changed(plugins={"motion": [1]}), "'motion'[0]: expected str, got 1"),
        (changed(scans_not_fused=None), "field 'scans_not_fused': expected int, got None"),
        (of_pick(slot=1.5), "field 'picks'[0], field 'slot': expected int, got 1.5"),
        (of_pick(planned_pose="eye"), "'planned_pose': expected an array of numbers, got 'eye'"),
        (of_pick(planned_pose=[[1], [1, 2]]), "'planned_pose': expected an array of numbers"),
        (of_pick(plased=True), "field 'picks'[0] has no field 'plased'"),
        (of_truth(stance={"tilt": 1}), "field 'truth', field 'stance' has no field 'tilt'"),
        (of_truth(stance=None), "field 'stance': expected a mapping, got None"),
        (of_truth(collisions=[{"bodies": ["boom"]}]), "'collisions'[0] lacks its field 'from_s'"),
        (
            of_truth(collisions=[{**TRUTH["collisions"][0], "bodies": ["boom"]}]),
            "field 'bodies': expected a list of 2, got ['boom']",
        ),
        ([], "the report: expected a mapping, got []"),
        (3, "the report: expected a mapping, got 3"),
        ({**CUT_OFF, "outcome": "success"}, "field 'outcome': expected one of fault"),
    ],
)
def test_what_is_of_another_form_is_named_with_its_file_and_a_cure(
    path: Path, content: object, words: str
) -> None:
    with pytest.raises(DataError) as refused:
        read_report(put(path, content))
    assert words in str(refused.value)
    assert str(refused.value).startswith(f"{path}: ")
    assert "read it with the version that wrote it" in str(refused.value)


def test_a_long_value_is_shown_by_its_begin(path: Path) -> None:
    with pytest.raises(DataError) as refused:
        read_report(put(path, changed(seed="x" * 5000)))
    assert len(str(refused.value)) < 400 + len(str(path))


@pytest.mark.parametrize(
    "text",
    [
        "",
        "no JSON",
        json.dumps(WHOLE)[:-1],
        json.dumps(WHOLE)[:2000],
        "[" * 100_000,
    ],
    ids=["empty", "no JSON", "without its end", "truncated", "too deep"],
)
def test_what_is_no_json_is_told_with_its_file_and_a_cure(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
    with pytest.raises(DataError, match=r"not a report of a run: .*`executive journal`") as refused:
        read_report(path)
    assert str(refused.value).startswith(f"{path}: ")


def test_bytes_that_are_no_text_and_a_folder_are_told(path: Path) -> None:
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(DataError, match="not a report of a run"):
        read_report(path)
    path.unlink()
    path.mkdir()
    with pytest.raises(DataError, match="not a report of a run"):
        read_report(path)


def test_a_report_that_is_not_there_is_told_with_what_to_do(path: Path) -> None:
    with pytest.raises(DataError, match=r"there is no report: .*`executive resume`"):
        read_report(path)


def test_how_a_run_ended_is_read_from_a_report_of_any_version(path: Path) -> None:
    older = {"outcome": "stopped", "reason": "by the operator", "colour": "red"}
    ending = read_ending(put(path, older))
    assert isinstance(ending, MissionEnding)
    assert (ending.outcome, ending.reason) == ("stopped", "by the operator")
    assert ending_in({"outcome": "success"}).reason is None
    assert ending_in(WHOLE).outcome == "fault"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ({"reason": ""}, "lacks its field 'outcome'"),
        ({"outcome": "won"}, "expected one of success, failure, stopped, fault, got 'won'"),
        ([1], r"expected a mapping, got \[1\]"),
    ],
)
def test_a_report_that_does_not_tell_how_the_run_ended_is_refused(
    path: Path, content: object, words: str
) -> None:
    with pytest.raises(DataError, match=words) as refused:
        read_ending(put(path, content))
    assert str(refused.value).startswith(f"{path}: ")


def test_a_report_that_cannot_be_written_leaves_the_one_before(path: Path) -> None:
    put(path, WHOLE)
    path.with_suffix(".partial").mkdir()
    with pytest.raises(OSError, match="partial"):
        write_report(path, blank(MissionReport))
    assert json.loads(path.read_text(encoding="utf-8")) == WHOLE


def test_the_outcomes_of_a_cut_off_run_are_outcomes_of_a_run() -> None:
    hints = get_type_hints(CutOffReport), get_type_hints(MissionReport)
    assert set(get_args(hints[0]["outcome"])) < set(get_args(hints[1]["outcome"]))
