"""`executive import`: what it writes, and what it refuses."""

import json
import sys
from pathlib import Path
from typing import Any

import pytest

from executive.commands.main import main
from executive.tree.load import load_mission

PATROL = """<root BTCPP_format="4" main_tree_to_execute="Patrol">
  <BehaviorTree ID="Patrol">
    <Sequence>
      <Timeout msec="30000"><Localise/></Timeout>
      <ScanSwing angle="1.5" duration="10.0"/>
      {more}
    </Sequence>
  </BehaviorTree>
</root>"""


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: Any) -> Any:
    monkeypatch.chdir(tmp_path)

    def ended(more: str, *options: str) -> tuple[int, str, str]:
        Path("patrol.xml").write_text(PATROL.format(more=more), encoding="utf-8")
        monkeypatch.setattr(sys, "argv", ["executive", "import", *options])
        with pytest.raises(SystemExit) as end:
            main()
        told = capsys.readouterr()
        return int(end.value.code or 0), told.out, told.err

    return ended


def test_an_imported_mission_is_one_that_loads(run: Any) -> None:
    given = ("patrol.xml", "--extends", "base", "--out", "patrol.yaml")
    status, out, err = run("", *given)
    assert (status, out) == (0, "")
    assert err == "patrol.yaml: 1 tree; `executive check patrol.yaml` checks them\n"
    mission = load_mission("patrol.yaml")
    assert [node.label for node in mission.trees["main"].root.children()] == [
        "Localise",
        "ScanSwing",
    ]


def test_an_imported_mission_goes_to_standard_output(run: Any) -> None:
    status, out, err = run("", "patrol.xml")
    assert (status, err) == (0, "")
    assert out.startswith(
        "api: 1\nmission: patrol\ntrees:\n  main:\n    sequence:\n    - run: Localise"
    )
    _, out, _ = run("", "patrol.xml", "--json")
    assert json.loads(out)["trees"]["main"]["sequence"][0] == {"run": "Localise", "timeout": 30.0}


def test_what_cannot_be_said_is_listed_and_nothing_is_written(run: Any) -> None:
    more = (
        '<AsyncSequence><Localise/></AsyncSequence>\n<Script code="a ? 1 : 2"/>\n'
        '<ScanSwing agle="2"/>'
    )
    status, out, err = run(more, "patrol.xml", "--out", "patrol.yaml")
    assert (status, out) == (2, "")
    lines = err.splitlines()
    assert lines[0].startswith(
        "patrol.xml:6:7: error: AsyncSequence cannot be said: it ends the tick"
    )
    assert lines[1].startswith(
        "patrol.xml:7:1: error: Script cannot be said: 'a ? 1 : 2': there is no"
    )
    assert lines[2] == "patrol.xml:8:1: error: ScanSwing has no port 'agle'. Did you mean 'angle'?"
    assert not Path("patrol.yaml").exists()


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("nowhere.xml",), "error: nowhere.xml cannot be read: "),
        (("patrol.xml", "--extends", "bse"), "error: --extends: 'bse' is no file and no shipped"),
        (
            ("patrol.xml", "--out", "no/folder.yaml"),
            "error: --out: no/folder.yaml: name a file in a folder",
        ),
    ],
)
def test_bad_input_is_refused(run: Any, options: tuple[str, ...], told: str) -> None:
    status, _, err = run("", *options)
    assert (status, err[: len(told)]) == (2, told)
