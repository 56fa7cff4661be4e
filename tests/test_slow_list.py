"""The list of slow tests names tests that exist."""

from pathlib import Path

import pytest

HERE = Path(__file__).parent
NAMES = [line for line in (HERE / "slow.txt").read_text().splitlines() if line[:1] not in ("", "#")]


@pytest.mark.parametrize("name", NAMES)
def test_a_slow_test_exists(name):
    path, _, function = name.partition("::")
    assert f"def {function}(" in (HERE.parent / path).read_text()


def test_no_line_stands_twice():
    assert len(set(NAMES)) == len(NAMES)
