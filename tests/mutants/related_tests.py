"""Which tests concern a source file: those that mirror it, name it, or hold its contract."""

from functools import cache
from pathlib import Path

RECORDED = Path("tests/recorded")
SUITES = Path("executive/testing/suites")  # what every plugin of a capability must do
BESIDE = {  # tests of what is in a folder that are not in its mirror
    "executive/leaf": ("tests/behaviours", "tests/mission"),
    "executive/behaviours": ("tests/mission",),
    "executive/tree/btcpp": ("tests/tree/test_import.py", "tests/tree/test_export.py"),
}


def related(root: Path, file: str) -> list[tuple[str, ...]]:
    """Return what to run for a file, the nearest first; none if no test concerns it.

    Nearest are the test files of its name in its mirror and the recorded results of its mirror;
    then come the whole mirror with what is `BESIDE` it, for a plugin the suite of its capability,
    and all other test files that import it. The mirror of `executive/a/b.py` is `tests/a`, that of
    `plugins/x/room/y.py` is `tests/plugins/x/room` if there is one, else `tests/plugins/x`;
    recorded results are in the same folders under `tests/recorded`.
    """
    path = Path(file)
    is_plugin = path.parts[0] == "plugins"
    place = Path(*path.parts[0 if is_plugin else 1 :])
    mirror = _mirror(root, Path("tests") / place)
    near = [p.relative_to(root) for p in sorted((root / mirror).rglob(f"test_{path.stem}.py"))]
    near += _recorded(root, place)
    wide = [mirror.as_posix()] if mirror != Path("tests") else []
    wide += [test for beside, of in BESIDE.items() if path.is_relative_to(beside) for test in of]
    others = [
        p.as_posix()
        for p in _importing(root, module_of(path))
        if not any(p.is_relative_to(folder) for folder in (*near, *wide))
    ]
    stages = [[p.as_posix() for p in near], [p for p in wide if (root / p).exists()]]
    if is_plugin and (root / SUITES / f"test_{path.parts[1]}.py").is_file():
        kit = ["-p", "executive.testing.pytest_plugin", "--capability", path.parts[1]]
        stages.append([*kit, SUITES.as_posix()])
    return [tuple(stage) for stage in (*stages, others) if stage]


def _recorded(root: Path, place: Path) -> list[Path]:
    """Return the folders of recorded results that mirror those above a file, the nearest first."""
    return [
        RECORDED / folder
        for folder in place.parents
        if folder not in (Path(), Path("plugins"))
        and any((root / RECORDED / folder).glob("test_*.py"))
    ]


def _mirror(root: Path, path: Path) -> Path:
    """Return the nearest folder above a file's mirror that there is."""
    for folder in path.parents:
        if (root / folder).is_dir() and folder != Path("tests/plugins"):
            return folder
    return Path("tests")


def module_of(path: Path) -> str:
    """Return the name of the module that a file of the tree is."""
    parts = list(path.with_suffix("").parts)
    parts = parts[:-1] if parts[-1] == "__init__" else parts
    return ".".join([{"plugins": "executive_plugins"}.get(parts[0], parts[0]), *parts[1:]])


def _importing(root: Path, module: str) -> list[Path]:
    """Return the test files that name a module."""
    parent, _, name = module.rpartition(".")
    words = (f"{module} import", f"import {module}", f"from {parent} import {name}")
    return [
        path.relative_to(root)
        for path, text in _test_sources(root).items()
        if any(word in text for word in words)
    ]


@cache
def _test_sources(root: Path) -> dict[Path, str]:
    return {
        path: path.read_text(encoding="utf-8")
        for path in sorted((root / "tests").rglob("test_*.py"))
        if "benchmarks" not in path.parts
    }
