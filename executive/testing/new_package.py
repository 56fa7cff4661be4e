"""A small package with one plugin or leaf that keeps its contract: a beginning of one's own."""

import re
from importlib.resources import files
from importlib.util import find_spec
from keyword import iskeyword
from pathlib import Path
from sys import stdlib_module_names

from executive import registry
from executive.errors import ConfigError, did_you_mean

LEAF = "leaf"
_NAME = re.compile(r"[a-z][a-z0-9_]*")


def new_package(capability: str, name: str, into: Path) -> tuple[Path, ...]:
    """Write a package that passes the kit, in a new folder of the plugin's name.

    Args:
        capability: A shipped capability, or `leaf`.
        name: The plugin's name in lower case, such as `steep_ground`.
        into: The folder that the new folder is made in.

    Returns:
        The files that were written.

    Raises:
        ConfigError: If there is no such capability, the name is no name or that of a module which
            Python finds, or the folder exists.
    """
    templates = files("executive.testing") / "templates"
    known = sorted(one.name.removesuffix(".py.txt") for one in templates.iterdir())
    if capability not in known:
        raise ConfigError(f"no capability '{capability}'{did_you_mean(capability, known)}")
    if not _NAME.fullmatch(name):
        raise ConfigError(f"'{name}' is no name: use a-z, 0-9 and _, and begin with a letter")
    folder = into / name
    if folder.exists():
        raise ConfigError(f"{folder} exists already: choose another name or folder with --into")
    if taken := _taken_by(name):
        raise ConfigError(f"'{name}' is taken: {taken}; choose another name")
    class_name = "".join(word.capitalize() for word in name.split("_"))
    group, announced = (
        (registry.BEHAVIOURS, class_name) if capability == LEAF else (capability, name)
    )
    text = (templates / f"{capability}.py.txt").read_text(encoding="utf-8")
    module = text.replace("__CLASS__", class_name).replace("__NAME__", name)
    words = {"name": name, "class": class_name, "group": group, "announced": announced}
    written = {
        f"{name}.py": module,
        "pyproject.toml": _PYPROJECT.format(**words),
        f"test_{name}.py": _TEST.format(**words, capability=capability),
        "README.md": _README.format(**words, capability=capability),
    }
    folder.mkdir(parents=True)
    for file, content in written.items():
        (folder / file).write_text(content, encoding="utf-8")
    return tuple(folder / file for file in written)


def _taken_by(name: str) -> str:
    """Return what else has the name, or an empty text; nothing is imported.

    The package's module is installed beside all others, and the first of two of one name on the
    path hides the other.
    """
    if iskeyword(name):
        return "it is a word of Python"
    if name in stdlib_module_names:
        return "Python's library has a module of that name"
    found = find_spec(name)
    if found is None or found.origin is None:  # a folder without __init__.py hides no module
        return ""
    return f"{found.origin} has that name"


_PYPROJECT = """\
[build-system]
requires = ["setuptools>=77"]
build-backend = "setuptools.build_meta"

[project]
name = "{name}"
version = "0.1.0"
dependencies = ["executive[testing]"]

[project.entry-points."executive.{group}.v1"]
{announced} = "{name}:{class}"

[tool.setuptools]
py-modules = ["{name}"]
"""

_TEST = '''\
"""The contract, as `executive plugins test {capability} {announced}` checks it."""

from executive.testing.run import Trial, hold_to_contract


def test_it_keeps_its_contract():
    findings = hold_to_contract(Trial("{capability}", "{announced}"))
    assert not [one.line() for one in findings if one.outcome == "fail"]
'''

_README = """\
# {name}

A {capability} for the task executive. `{name}.py` is a beginning that keeps the contract; where no
simple method exists it answers with a failure value and says so. Write yours in its place.

    pip install -e .
    executive plugins test {capability} {announced}
"""
