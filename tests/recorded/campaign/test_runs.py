"""Pages and comparisons of single runs whose folders are written by hand, some of them damaged."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from executive.campaign.reporting.runs.comparison_text import comparison_answer, comparison_text
from executive.campaign.reporting.runs.read_run import read_run
from executive.campaign.reporting.runs.run_comparison import compare_runs
from executive.campaign.reporting.runs.run_report import measured_words, report_run, run_answer
from executive.campaign.reporting.runs.timeline import attempt_bars, leaf_bars, timeline
from executive.errors import ConfigError
from executive.events.mission import Fault
from executive.events.node import NodeEnded, NodeStarted
from executive.events.stone import StoneGrasped
from executive.interfaces.report import (
    AttemptReport,
    Counts,
    CutOffReport,
    MissionReport,
    PickReport,
    Resources,
    Timing,
)
from executive.interfaces.truth import (
    AngleErrors,
    Collision,
    EstimateErrors,
    PositionErrors,
    TrueGrasp,
    TrueStone,
    Truth,
)
from executive.journal import Journal
from executive.testing.blank import blank


def tried(began_s: float, outcome: str, reason: str = "") -> AttemptReport:
    return blank(
        AttemptReport, started_s=began_s, ended_s=began_s + 7.25, outcome=outcome, reason=reason
    )


def stone(number: int, slot_m: float | None, held: int | None, base: float | None) -> TrueStone:
    return blank(
        TrueStone,
        id=number,
        slot_error_m=slot_m,
        held_object=held,
        database_error_m=base,
        database_error_rad=base,
    )


REPORT = blank(
    MissionReport,
    mission="made_up",
    seed=7,
    outcome="success",
    ended_s=125.5,
    wall_s=31.0,
    real_time_factor=4.05,
    resources=Resources(40.0, 3 * 10**8),
    counts=blank(Counts, slips=1),
    timings_ms={"motion.move": Timing(20.0, 35.0, 12), "mapping.cloud": Timing(2.0, 3.0, 500)},
    picks=(
        blank(
            PickReport,
            object=1,
            slot=3,
            placed=True,
            attempts=(tried(10, "slip"), tried(20, "placed")),
        ),
        blank(
            PickReport,
            object=2,
            slot=4,
            set_aside="too heavy",
            attempts=(tried(40, "drop", "it fell"),),
        ),
    ),
    truth=blank(
        Truth,
        stones=(stone(1, 0.05, 1, 0.02), stone(2, None, None, None)),
        collisions=(blank(Collision),),
        grasps=(TrueGrasp(1, lifted=True, dropped=False),) * 3,
        estimate=EstimateErrors(
            PositionErrors(0.02, 0.01, 0.1, 0.015, 0.005), AngleErrors(0.003, 0.001, 0.004)
        ),
    ),
)
OTHER = replace(
    REPORT,
    seed=8,
    outcome="fault",
    reason="it broke",
    fault=blank(Fault, component="motion plugin 'mine'", error="KeyError"),
    timings_ms={"motion.move": Timing(25.0, 35.0, 12)},
    picks=REPORT.picks[:1],
    truth=None,
    counts=blank(Counts, slips=2),
)
CUT_OFF = CutOffReport("made_up", "fault", "killed", OTHER.fault)


def started(node: str) -> tuple[str, Any]:
    return node, NodeStarted()


def ended(node: str, status: str) -> tuple[str, Any]:
    values = {"status": status, "reason": "so"}
    names = NodeEnded.__dataclass_fields__
    return node, NodeEnded(**{name: value for name, value in values.items() if name in names})


COURSE = (
    started("main/0:scan"),
    ended("main/0:scan", "success"),
    started("main/1:pick"),
    started("main/1:pick/0:grasp"),
    ("main/1:pick/0:grasp", StoneGrasped(1, 0.25, 10, 2)),
    ended("main/1:pick/0:grasp", "failure"),
    ended("main/1:pick", "failure"),
    started("main/2:wait"),
)
MISSION = "name: made_up\nloop: {tick: 0.05}\nplugins: {motion: {plugin: hermite}}\n"


def written(folder: Path, report: Any, course: Any = COURSE, mission: str = MISSION) -> Path:
    folder.mkdir()
    (folder / "report.json").write_text(json.dumps(report.payload()))
    (folder / "mission.yaml").write_text(mission)
    journal = Journal(folder / "journal.jsonl")
    for number, (node, event) in enumerate(course):
        journal.append(number, 1.5 * number, node, event)
    journal.close()
    return folder


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run in an empty folder, so that no path of this computer is told."""
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("report", [REPORT, OTHER, CUT_OFF], ids=["whole", "fault", "cut off"])
def test_a_page(recorded, report) -> None:
    run = read_run(written(Path("run"), report))
    page = report_run(run).read_text(encoding="utf-8")
    body = page.split("</main>")[0].split("<main>")[1]
    recorded(re.sub(r">\s*<", ">\n<", re.sub(r"<script.*?</script>", "", body, flags=re.S)))
    recorded(run_answer(run))
    recorded(
        (timeline(leaf_bars(run.entries)), list(attempt_bars(run.whole.picks if run.whole else ())))
    )


def test_damaged_runs(recorded) -> None:
    told = []
    for number, (name, text) in enumerate(
        (
            ("report.json", "{"),
            ("report.json", "[]"),
            ("mission.yaml", "- 1"),
            ("mission.yaml", "a: ["),
            ("journal.jsonl", "{}\n"),
            ("journal.jsonl", '{"cut'),
            ("report.json", None),
            ("journal.jsonl", None),
            ("mission.yaml", None),
            ("dry_run.json", "{}"),
        )
    ):
        folder = written(Path(f"run_{number}"), REPORT)
        (folder / name).unlink(missing_ok=True)
        if text is not None:
            (folder / name).write_text(text)
        (folder / "log.txt").write_text("printed\n" * 30 + "the end\n")
        try:
            run = read_run(folder)
        except ConfigError as error:
            told.append(str(error))
            continue
        told.append(list(run.damages))
        told.append((run.command, len(run.entries), len(run.measurements)))
        told.append(run_answer(run)["journal"]["last"])
    for folder in (Path("none"), Path()):
        with pytest.raises(ConfigError) as refused:
            read_run(folder)
        told.append(str(refused.value))
    recorded(told)


def test_comparisons(recorded) -> None:
    later = (*COURSE[:3], ("main/1:pick", StoneGrasped(2, 0.5, 1, 0)), *COURSE[3:])
    other_mission = MISSION.replace("0.05", "0.1").replace("}}", ", speed: [1, 2]}}")
    runs = [
        read_run(written(Path("one"), REPORT)),
        read_run(written(Path("same"), REPORT)),
        read_run(written(Path("two"), OTHER, later, other_mission)),
        read_run(written(Path("three"), OTHER, COURSE[:4])),
        read_run(written(Path("four"), CUT_OFF)),
    ]
    for other in runs[1:]:
        compared = compare_runs(runs[0], other)
        recorded(comparison_text(compared).split("\n"))
        recorded(json.loads(json.dumps(comparison_answer(compared), default=float)))


def test_measured_words(recorded) -> None:
    told = []
    for measured in (
        {"problem": "no truth"},
        {"hits": 3, "of": 4},
        {"hits": 0, "of": 0},
        {"values": []},
        {"values": [2.5]},
        {"values": list(np.linspace(9.0, 0.0, 8))},
    ):
        told += [measured_words(name, measured) for name in ("placement_error", "slips", "no_such")]
    recorded(told)
