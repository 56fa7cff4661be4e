"""Finds missions and subtrees: a file, a shipped name, an extended base, a subtrees folder."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from pathlib import Path

from executive.errors import did_you_mean
from executive.tree.document import read_file
from executive.tree.problem import Mark, MissionFileError, Problem, Problems
from executive.tree.reading import Reading
from executive.tree.value import Scalar, Table, TableEntry, Value

_SUFFIXES = (".yaml", ".yml")
API = 1
MISSION_KEYS = (
    "api",
    "mission",
    "description",
    "extends",
    "loop",
    "plugins",
    "regions",
    "watch",
    "faults",
    "trees",
)
LIBRARY_KEYS = ("api", "trees")


@dataclass(frozen=True, slots=True)
class Layer:
    """One mission file, read but not yet understood."""

    path: Path
    table: Table


def shipped_folder() -> Path:
    """Return the folder of the missions that come with the package."""
    return Path(str(files("executive_trees")))


def shipped_names() -> tuple[str, ...]:
    """List the missions that come with the package; files of subtrees are not among them."""
    return tuple(sorted(set(_shipped()) - {"base"}))


def find(mission: str) -> Path | None:
    """Return the path of a mission: a file, else the shipped mission of that name."""
    path = Path(mission)
    if mission.endswith(_SUFFIXES) or "/" in mission or _is_file(path):
        return path
    return _shipped().get(mission)


def _shipped() -> dict[str, Path]:
    """Return the files of the missions that come with the package, those of examples included."""
    folder = shipped_folder()
    return {path.stem: path for path in (*folder.glob("examples/*.yaml"), *folder.glob("*.yaml"))}


def _find_base(name: str, folder: Path) -> Path | None:
    """Return the path of a base: a file beside the extending one, else a shipped mission."""
    near = [folder / name, *([folder / f"{name}.yaml"] if _is_word(name) else [])]
    return next((path for path in near if _is_file(path)), _shipped().get(name))


def _is_word(text: str) -> bool:
    return text.replace("_", "").replace("-", "").isalnum()


def layers(mission: str, reading: Reading) -> list[Layer]:
    """Read a mission and what it extends, base first.

    Raises:
        MissionFileError: If there is no such mission.
    """
    path = find(mission)
    if path is None:
        told = (
            "no mission file and no shipped mission of that "
            f"name{did_you_mean(mission, shipped_names())}"
        )
        raise MissionFileError([Problem(Mark(mission or "MISSION"), told)])
    found: list[Layer] = []
    seen: set[Path] = set()
    while path is not None:
        layer = _layer(path, reading)
        if layer is None:
            reading.problems.is_partial = True
            break
        seen.add(path.resolve())
        found.insert(0, layer)
        path = _base(layer, seen, reading)
    return found


def _layer(path: Path, reading: Reading) -> Layer | None:
    value = read_file(path, shown(path), reading.problems)
    table = reading.table(value, "a mission file") if value is not None else None
    if table is None:
        return None
    reading.known_keys(table, MISSION_KEYS, "a mission file")
    check_api(table, reading)
    return Layer(path, table)


def check_api(table: Table, reading: Reading) -> None:
    """Note a version of the language that is missing or not known."""
    api = table.get("api")
    if api is None:
        reading.problems.error(table.mark, f"'api' is missing; write 'api: {API}'")
    elif not isinstance(api, Scalar) or type(api.value) is not int or api.value != API:
        reading.fail(api, f"this version reads 'api: {API}'")


def _base(layer: Layer, seen: set[Path], reading: Reading) -> Path | None:
    value = layer.table.get("extends")
    name = reading.text(value, "'extends'") if value is not None else None
    if value is None or name is None:
        return None
    path = _find_base(name, layer.path.parent)
    if path is None:
        known = [one.stem for one in layer.path.parent.glob("*.yaml")] + ["base", *shipped_names()]
        reading.fail(value, f"no file '{name}' to extend{did_you_mean(name, known)}")
        reading.problems.is_partial = True
        return None
    if path.resolve() in seen:
        reading.fail(value, f"files extend each other in a circle: {name}")
        return None
    return path


def libraries(mission: Path, reading: Reading) -> Iterator[Table]:
    """Read the trees of the shipped `subtrees/` folder and of the one beside the mission."""
    folders = [shipped_folder() / "subtrees", mission.parent / "subtrees"]
    for folder in dict.fromkeys(folder.resolve() for folder in folders):
        tables = [
            table
            for path in sorted(folder.glob("*.yaml"))
            if (table := _library(path, reading)) is not None
        ]
        if tables:
            yield _joined(tables, reading)


def _joined(tables: Sequence[Table], reading: Reading) -> Table:
    entries: dict[str, TableEntry] = {}
    for table in tables:
        for name, entry in table.entries.items():
            if name in entries:
                told = f"tree '{name}' is given twice; the first is at {entries[name].key_mark}"
                reading.problems.error(entry.key_mark, told)
            entries.setdefault(name, entry)
    return Table(entries, tables[0].mark)


def _library(path: Path, reading: Reading) -> Table | None:
    value = _library_value(path, reading)
    table = reading.table(value, "a file of subtrees") if value is not None else None
    if table is None:
        reading.problems.is_partial = True
        return None
    reading.known_keys(table, LIBRARY_KEYS, "a file of subtrees")
    check_api(table, reading)
    trees = table.get("trees")
    if trees is None:
        reading.fail(table, "a file of subtrees needs 'trees'")
        return None
    return reading.table(trees, "'trees'")


def _library_value(path: Path, reading: Reading) -> Value | None:
    """Read a file of subtrees; every mission of a process needs them, and they seldom change."""
    try:
        state = path.stat()
    except OSError:
        return read_file(path, shown(path), reading.problems)
    value, problems = _read_once(path, shown(path), (state.st_mtime_ns, state.st_size))
    for problem in problems:
        reading.problems.error(problem.mark, problem.message)
    return value


@lru_cache(maxsize=64)
def _read_once(
    path: Path, name: str, _state: tuple[int, int]
) -> tuple[Value | None, tuple[Problem, ...]]:
    problems = Problems()
    value = read_file(path, name, problems)
    return value, problems.all()


def shown(path: Path) -> str:
    """Return how messages call a file: relative to the current folder if it is below it."""
    here = Path.cwd()
    return str(path.relative_to(here)) if path.is_relative_to(here) else str(path)


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # a name that is too long, or holds a NUL
        return False
