"""The generated pages and pictures are those of the code as it is."""

import importlib.util
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

DOCS = Path(__file__).parents[2] / "docs"


def script(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, DOCS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def pages() -> Iterator[dict[Path, str]]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(DOCS)  # as when the script runs
        yield script("generate").pages()


@pytest.mark.parametrize(
    "name",
    ["words.md", "robot_yaml.md", "journal_events.md", "metrics.md", "how-to/write_a_tree.md"],
)
def test_a_page_is_what_the_script_would_write(name: str, pages: dict[Path, str]) -> None:
    assert (DOCS / name).read_text(encoding="utf-8") == pages[DOCS / name], (
        f"docs/{name} is out of date: run `python docs/generate.py`"
    )


def test_the_words_have_a_meaning(pages: dict[Path, str]) -> None:
    rows = re.findall(
        r"^\| (?:in|out|with) \| `(\w+)` \| .+ \| .* \|(.*)\|$", pages[DOCS / "words.md"], re.M
    )
    assert len(rows) > 50
    assert [name for name, meaning in rows if not meaning.strip()] == []


def test_the_picture_shows_every_layer_and_every_capability() -> None:
    module = script("architecture_picture")
    drawn = re.findall(r">\s*([a-z_]+)\s*</text>", module.PATH.read_text(encoding="utf-8"))
    layers = {name for row in module.layers() for name in row}
    assert layers <= set(drawn), "run `python docs/architecture_picture.py`"
    assert set(module.CAPABILITIES) <= set(drawn)


def test_the_table_of_layers_is_the_contract() -> None:
    page = (DOCS / "architecture.md").read_text(encoding="utf-8")
    rows = re.findall(
        r"^\| ((?:`\w+`(?:, )?)+) \|", page.split("## Layers")[1].split("##")[0], re.M
    )
    layers = [re.findall(r"`(\w+)`", row) for row in rows]
    assert layers == script("architecture_picture").layers()


def test_the_picture_of_the_tree_shows_its_leaves() -> None:
    module = script("tree_picture")
    picture = (module.IMAGES / "tree.svg").read_text(encoding="utf-8")
    for name in ("Localise", "SurveySite", "RegisterDroneMap", "SelectLargest", "move_stone"):
        assert name in picture, "run `python docs/tree_picture.py`"
