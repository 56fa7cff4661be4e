"""The pages on perception are true: their tables are those that the benchmark makes of what was
measured.
"""

import importlib.util
import json
import re
from pathlib import Path
from types import ModuleType

import pytest

from executive import registry

ROOT = Path(__file__).parents[2]
HOW_TO = (ROOT / "docs" / "how-to" / "perception.md").read_text(encoding="utf-8")
EVIDENCE = (ROOT / "docs" / "evidence" / "perception.md").read_text(encoding="utf-8")
FIGURES = json.loads((ROOT / "docs" / "perception_figures.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def tables() -> ModuleType:
    path = ROOT / "tests" / "benchmarks" / "perception" / "figure_table.py"
    spec = importlib.util.spec_from_file_location("figure_table", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", ["bounds", "beside_the_paper", "decoys", "piles"])
def test_its_tables_are_made_of_what_was_measured(tables: ModuleType, name: str) -> None:
    assert getattr(tables, name)(FIGURES) in EVIDENCE


def test_what_does_not_hold_is_bold(tables: ModuleType) -> None:
    worse = json.loads(json.dumps(FIGURES))
    worse["swing_20_s"]["right"] = 50
    assert "| **50 of 60, 0 wrong accepted** |" in tables.bounds(worse)
    changed = [row.what for row in tables.ROWS if row.is_met(worse) != row.is_met(FIGURES)]
    assert changed == ["right (< 1°, < 5 cm), swings of 20 s"]


def test_a_row_that_was_not_measured_says_so(tables: ModuleType) -> None:
    assert tables.bounds({}).count("**not measured**") == len(tables.ROWS)


def test_it_names_every_registrar() -> None:
    rows = re.search(r"\| plugin \| motions.*?\n\n", HOW_TO, re.S).group(0)
    assert set(re.findall(r"^\| `(\w+)` \|", rows, re.M)) == {
        point.name for point in registry.installed("registration")
    }
