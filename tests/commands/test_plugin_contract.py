"""`executive plugins test` tells each check of one plugin, and its exit status whether all held."""

import json
import sys

import pytest

from executive.commands.main import main
from executive.testing import run as run_module
from executive.testing.finding import Finding, Outcome

FINDINGS = (
    Finding("it answers", Outcome.PASS, "", "", 0.1),
    Finding("it refuses", Outcome.FAIL, "it took a NaN", "a.py:3", 0.2),
    Finding("it is fast", Outcome.SKIP, "no clock", "", 0.0),
    Finding("it is quiet", Outcome.SKIP, "no ear", "", 0.0),
)


@pytest.fixture
def hold(monkeypatch, capsys):
    """Run the verb over findings; return status, both outputs, and what was asked for."""

    def hold(findings, *options):
        asked = []
        monkeypatch.setattr(
            run_module, "hold_to_contract", lambda trial: asked.append(trial) or findings
        )
        words = ["executive", "plugins", "test", "mapping", "voxel_map", *options]
        monkeypatch.setattr(sys, "argv", words)
        with pytest.raises(SystemExit) as ended:
            main()
        told = capsys.readouterr()
        return ended.value.code, told.out, told.err, asked[0]

    return hold


def test_one_line_a_check_and_status_one_for_a_failure(hold):
    code, out, err, trial = hold(FINDINGS)
    assert code == 1
    assert out.splitlines() == [
        "PASS  it answers",
        "FAIL  it refuses (a.py:3): it took a NaN",
        "SKIP  it is fast: no clock",
        "SKIP  it is quiet: no ear",
    ]
    assert err == "mapping voxel_map: 1 passed, 1 failed, 2 skipped\n"
    assert trial == run_module.Trial("mapping", "voxel_map", (), "m545", 30.0, False)


def test_skipped_checks_are_no_failure_and_json_says_so(hold):
    options = ("--json", "--set", "a=1", "--model", "mini", "--time-limit", "2", "--must-succeed")
    code, out, _, trial = hold((FINDINGS[0], FINDINGS[2]), *options)
    assert code == 0
    assert json.loads(out) == {
        "capability": "mapping",
        "name": "voxel_map",
        "passed": True,
        "checks": [FINDINGS[0].as_json(), FINDINGS[2].as_json()],
    }
    assert trial == run_module.Trial("mapping", "voxel_map", ("a=1",), "mini", 2.0, True)


def test_a_failure_is_told_as_json_too(hold):
    code, out, _, _ = hold(FINDINGS, "--json")
    assert (code, json.loads(out)["passed"]) == (1, False)
