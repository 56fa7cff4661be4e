"""Each example has a page with its whole text, its picture, and the command that runs it."""

import re
from pathlib import Path

import executive_trees
import pytest

DOCS = Path(__file__).parents[2] / "docs"
EXAMPLES = sorted((Path(executive_trees.__file__).parent / "examples").glob("*.yaml"))


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_a_page_shows_the_example_as_it_is_shipped(path):
    page = (DOCS / "cookbook" / f"{path.stem}.md").read_text(encoding="utf-8")
    assert f"executive run {path.stem}" in page
    shown = re.findall(r"```yaml\n(.*?)```", page, re.S)
    assert path.read_text(encoding="utf-8") in shown


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_a_page_shows_the_picture_of_its_tree(path):
    page = (DOCS / "cookbook" / f"{path.stem}.md").read_text(encoding="utf-8")
    (picture,) = re.findall(r"\]\(\.\./images/(\w+\.svg)\)", page)
    drawn = (DOCS / "images" / picture).read_text(encoding="utf-8")
    named = re.findall(r"(?:run|check|call): (\w+)", path.read_text(encoding="utf-8"))
    missing = [name for name in named if name not in drawn]
    assert not missing, f"{missing}: run `python docs/tree_picture.py {path.stem}`"


def test_the_index_lists_every_example():
    index = (DOCS / "cookbook" / "index.md").read_text(encoding="utf-8")
    assert [path.stem for path in EXAMPLES if f"({path.stem}.md)" not in index] == []
