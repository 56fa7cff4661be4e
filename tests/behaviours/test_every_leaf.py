"""No shipped leaf is left out: each is ticked in a tree by a test of this folder."""

import re
from pathlib import Path

import pytest

from executive.registry import BEHAVIOURS, installed, load

HERE = Path(__file__)
FILES = [*HERE.parent.glob("test_*_leaves.py"), *HERE.parent.glob("placing/test_*.py")]
TESTS = "".join(path.read_text() for path in FILES)
SHIPPED = [one.name for one in installed(BEHAVIOURS) if one.distribution == "executive"]


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_leaf_is_ticked(name):
    leaf = load(BEHAVIOURS, name).__name__
    assert re.search(rf"\.tick\(\s*{leaf}\b|\[.*\b{leaf}\b.*\]", TESTS)
