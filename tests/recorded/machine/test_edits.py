"""What is said to a robot.yaml with one value wrong, gone or renamed."""

import runpy
from pathlib import Path

import pytest

from executive.machine.machine import load_machine, machine_file
from executive.plain_yaml import read_plain_yaml

EDITS = runpy.run_path(str(Path(__file__).parents[1] / "edits.py"))


@pytest.mark.parametrize("model", ["m545", "mini"])
def test_edits(recorded, tmp_path, model) -> None:
    document = read_plain_yaml(machine_file(model))

    def read(text: str):
        (tmp_path / "robot.yaml").write_text(text, encoding="utf-8")
        return load_machine(str(tmp_path)).model_dump(mode="json")

    told = EDITS["answers"](document, 40, 5, tmp_path, read)
    del told["whole"]
    recorded(told)
