"""Which tests concern a source file: those that mirror it, name it, or hold its contract."""

from functools import cache
from pathlib import Path


def related(root: Path, file: str) -> list[str]:
    """Return test files and folders, the nearest first; none if nothing concerns the file.

    The mirror of `executive/a/b.py` is `tests/a`, that of `plugins/x/room/y.py` is
    `tests/plugins/x/room` if there is one, else `tests/plugins/x`; the suites of
    `tests/conformance` and whatever imports the module come after it.
    """
    path = Path(file)
    is_plugin = path.parts[0] == "plugins"
    mirror = Path("tests") / (path if is_plugin else Path(*path.parts[1:]))
    found = [mirror.parent / f"test_{path.stem}.py"]
    while mirror.parent not in (Path("tests"), Path("tests/plugins")):
        mirror = mirror.parent
        if (root / mirror).is_dir():
            found.append(mirror)
            break
    if is_plugin and len(path.parts) > 2:
        conformance = root / "tests" / "conformance"
        found += [p.relative_to(root) for p in sorted(conformance.glob(f"*{path.parts[1]}*.py"))]
    found += _importing(root, _module(path))
    names = list(dict.fromkeys(p.as_posix() for p in found if (root / p).exists()))
    return [name for name in names if not _is_under_another(name, names)]


def _is_under_another(name: str, names: list[str]) -> bool:
    """Return whether a file's folder is run as well, unless the file comes before it."""
    before = names[: names.index(name)]
    return any(name.startswith(f"{folder}/") for folder in before)


def _module(path: Path) -> str:
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
        path: path.read_text(encoding="utf-8") for path in sorted(root.glob("tests/**/test_*.py"))
    }
