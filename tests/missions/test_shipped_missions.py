"""No shipped mission is left out: each is run to its end by a test of this folder."""

from pathlib import Path

import executive_trees
import pytest

HERE = Path(__file__)
FOLDER = Path(executive_trees.__file__).parent
SHIPPED = sorted(path.stem for path in (*FOLDER.glob("*.yaml"), *FOLDER.glob("examples/*.yaml")))
TESTS = "".join(path.read_text() for path in HERE.parent.glob("test_*.py") if path != HERE)


@pytest.mark.parametrize("name", [name for name in SHIPPED if name != "base"])
def test_a_shipped_mission_is_run(name):
    assert f'"{name}"' in TESTS or f'"{name}.yaml"' in TESTS
