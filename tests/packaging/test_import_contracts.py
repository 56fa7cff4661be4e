"""The contracts of import-linter hold every package: none is left out that was added later."""

import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
ROOTS = {"executive", "executive_plugins", "executive_robot_models", "executive_trees"}
# What a plugin may import: the contract, what that is written in, and the wire to a robot.
FOR_PLUGINS = {
    *("arrays", "clock", "clouds", "config", "confined", "errors", "events", "extras", "geometry"),
    *("interfaces", "machine", "messages", "plain_yaml", "wire"),
}


def linter() -> Any:
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"][
        "importlinter"
    ]


def contract(name: str) -> Any:
    found = [one for one in linter()["contracts"] if one["name"] == name]
    assert len(found) == 1
    return found[0]


def parts() -> set[str]:
    """Return the packages and modules of the executive."""
    found = (path for path in (ROOT / "executive").iterdir() if path.name[0] != "_")
    return {path.stem for path in found if path.suffix == ".py" or (path / "__init__.py").is_file()}


def test_all_packages_are_looked_at() -> None:
    assert set(linter()["root_packages"]) == ROOTS


def test_no_circle_is_allowed_anywhere() -> None:
    circles = contract("No package and no folder within one imports in a circle")
    assert circles["type"] == "acyclic_siblings"
    assert set(circles["ancestors"]) == ROOTS
    assert not {"ignore_imports", "skip_descendants", "depth"} & circles.keys()


def test_each_part_of_the_executive_has_its_layer() -> None:
    layers = contract("The executive's layers: arrows point down")
    assert layers["exhaustive"]
    assert "ignore_imports" not in layers
    named = [name.strip() for layer in layers["layers"] for name in layer.split("|")]
    assert sorted(named) == sorted(parts())


def test_plugins_are_kept_from_each_part_that_is_not_theirs() -> None:
    forbidden = contract("Plugins know the contract, not the executive")["forbidden_modules"]
    names = {one.removeprefix("executive.") for one in forbidden}
    assert names == parts() - FOR_PLUGINS


def test_what_plugins_share_is_kept_from_each_of_them() -> None:
    shared = contract("What plugins share knows none of them")
    folders = {one.parent.name for one in (ROOT / "plugins").glob("*/__init__.py")}
    assert set(shared["forbidden_modules"]) == {
        f"executive_plugins.{name}" for name in folders - {"physics"}
    }
