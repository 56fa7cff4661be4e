"""The page on dry runs: its commands in order, its table, and what its file expects."""

import json
import re
import sys
from pathlib import Path

import pytest

from executive.commands.main import main
from executive.dry_run.expectation_reader import _EXPECTED
from executive.dry_run.script_reader import _OUTCOME_KEYS

PAGE = (Path(__file__).parents[2] / "docs/how-to/try_a_tree.md").read_text(encoding="utf-8")


@pytest.fixture
def executive(tmp_path, monkeypatch, capsys):
    """Run a command of the page in a folder with its files."""
    for name, text in re.findall(r"Save this as `(\S+)`:\n\n```yaml\n(.*?)```", PAGE, re.S):
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)

    def run(line: str):
        monkeypatch.setattr(sys, "argv", line.split())
        try:
            main()
        except SystemExit as end:
            return int(end.code or 0), *capsys.readouterr()
        return 0, *capsys.readouterr()

    return run


def test_its_commands_do_what_it_says(executive):
    lines = [
        line for block in re.findall(r"```sh\n(.*?)```", PAGE, re.S) for line in block.split("\n")
    ]
    first, mocked, many, kept, added = (line for line in lines if line)
    shown = re.search(r"```text\n(.*?)```", PAGE, re.S).group(1)
    status, _, errors = executive(first)
    assert status == 0
    assert shown in errors
    status, _, errors = executive(mocked)
    assert status == 0
    assert "expectations: 6, all met" in errors
    status, _, errors = executive(many)
    assert status == 0
    assert errors.split("never taken:\n")[1].strip() == "main/3:check: failure"
    assert executive(kept)[0] == 0
    status, output, _ = executive(f"{added} --json")
    assert status == 0
    assert len(json.loads(output)["runs"]) == 2


def test_a_broken_expectation_fails(executive, tmp_path):
    file = tmp_path / "no_grasp.yaml"
    file.write_text(file.read_text().replace("2.5 t", "2.5 kg"))
    status, _, errors = executive("executive run pick_twice.yaml --dry --mocks no_grasp.yaml")
    assert status == 1
    assert "no_grasp.yaml:14:10:" in errors


def test_every_word_of_a_file_is_explained():
    assert [word for word in (*_OUTCOME_KEYS, *_EXPECTED) if f"`{word}`" not in PAGE] == []
