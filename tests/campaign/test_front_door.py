"""`executive campaign` over work that crashes, hangs and is stopped, in a process of its own."""

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from executive.campaign.execution.ledger import Ledger

PROGRAM = Path(sys.executable).with_name("executive")


def campaign(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [PROGRAM, "campaign", *words], capture_output=True, text=True, cwd=folder, timeout=600
    )


def tries_of(folder: Path) -> list[int]:
    """Return how often each finished run was begun."""
    ledger = Ledger(folder / "results.sqlite")
    tries = [one.tries for one in ledger.outcomes()]
    ledger.close()
    return tries


@pytest.mark.usefixtures("misbehaving")
def test_an_interrupted_campaign_says_how_to_go_on_and_goes_on(tmp_path: Path) -> None:
    text = (
        "api: 1\ncampaign: slow\nwork: misbehaving\nseeds: [1, 2, 3, 4]\narguments: {for_s: 1.5}\n"
    )
    (tmp_path / "slow.yaml").write_text(text)
    words = [PROGRAM, "campaign", "slow.yaml", "--jobs", "1", "--out", "slow"]
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True, cwd=tmp_path) as process:
        assert process.stderr is not None
        first = process.stderr.readline()
        process.send_signal(signal.SIGINT)
        rest = process.stderr.read()
        assert process.wait(timeout=600) == 1
    assert first.startswith("1/4  run 0 (seed 1) done in ")
    assert "3 runs left; what has ended is kept" in rest
    assert "go on      executive campaign slow --resume" in rest

    resumed = campaign(tmp_path, "slow", "--resume", "--jobs", "2")
    assert resumed.returncode == 0, resumed.stderr
    assert resumed.stderr.startswith("1 of 4 runs have ended before\n")
    assert tries_of(tmp_path / "slow")[0] == 1
    assert len(tries_of(tmp_path / "slow")) == 4


@pytest.mark.usefixtures("misbehaving")
def test_failed_runs_are_told_with_their_reason_and_repeated_when_asked_for(tmp_path: Path) -> None:
    variants = "variants: {good: , bad: {behaviour: raises}, late: {behaviour: hangs}}"
    text = (
        f"api: 1\ncampaign: bad\nwork: misbehaving\nseeds: 1\n{variants}\nlimits: {{time: 10 s}}\n"
    )
    (tmp_path / "bad.yaml").write_text(text)
    done = campaign(tmp_path, "bad.yaml", "--out", "bad")
    assert done.returncode == 0  # there is no bound to miss
    assert "bad: 3 of 3 runs ended; 0 without success, 2 without an answer" in done.stderr
    assert "variant=bad) crashed in" in done.stderr
    assert "the arm is too short" in done.stderr
    assert "variant=late) timed out in" in done.stderr
    again = campaign(tmp_path, "bad", "--resume", "--again", "timed_out")
    assert "2 of 3 runs have ended before" in again.stderr
    assert tries_of(tmp_path / "bad") == [1, 1, 2]
