"""Every bad mission file is refused with exactly the mistakes that `expected.txt` lists, each at
its place.
"""

from pathlib import Path

import pytest

from executive.tree.catalogue import Catalogue
from executive.tree.load import load_mission
from executive.tree.problem import MissionFileError

FOLDER = Path(__file__).parents[1] / "missions" / "bad"
FILES = sorted(FOLDER.glob("*.yaml"))


def expected() -> dict[str, list[str]]:
    """Return the lines of `expected.txt` by file."""
    lines = [
        line
        for line in (FOLDER / "expected.txt").read_text().splitlines()
        if not line.startswith("#")
    ]
    return {
        path.name: [line for line in lines if line.startswith(f"{path.name}:")] for path in FILES
    }


EXPECTED = expected()


def test_there_are_at_least_sixty_bad_files() -> None:
    assert len(FILES) >= 60


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_a_bad_file_is_refused_with_every_mistake_at_its_place(
    path: Path, catalogue: Catalogue
) -> None:
    with pytest.raises(MissionFileError) as caught:
        load_mission(str(path), catalogue=catalogue)
    told = [
        str(problem).replace(f"{problem.mark.file}:", f"{path.name}:", 1)
        for problem in caught.value.problems
    ]
    assert told == EXPECTED[path.name]
    assert told, "a file without an expectation proves nothing"
    assert {Path(problem.mark.file).name for problem in caught.value.problems} == {path.name}
