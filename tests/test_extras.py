"""An extra that is not installed is named with its cure; nothing else of the plugin is broken."""

import json
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from executive import extras, registry
from executive.commands.main import main
from executive.extras import MissingExtraError, missing_packages, require_extra

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
OPTIONAL = PROJECT["optional-dependencies"]


def names(requirements: list[str]) -> set[str]:
    return {re.split(r"[><=\[]", one)[0] for one in requirements}


@pytest.fixture
def core_only(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """As if no package of any extra were installed."""
    core = names(PROJECT["dependencies"])
    optional = {name for extra in OPTIONAL.values() for name in names(extra)} - core
    monkeypatch.setattr(extras, "_is_installed", lambda name: name not in optional)
    registry.reread()
    yield
    registry.reread()


def ended(monkeypatch: pytest.MonkeyPatch, *words: str) -> object:
    monkeypatch.setattr("sys.argv", ["executive", *words])
    with pytest.raises(SystemExit) as caught:
        main()
    return caught.value.code


def test_all_of_them_are_in_the_extra_all() -> None:
    listed = set(re.findall(r"\w+", OPTIONAL["all"][0])) - {"executive"}
    assert listed == set(OPTIONAL) - {"all", "dev", "docs"}
    assert "executive[all]" in OPTIONAL["dev"]


def test_every_plugin_that_names_an_extra_is_installed_and_the_extra_exists() -> None:
    for key, extra in PROJECT["entry-points"]["executive.extra.v1"].items():
        group, name = key.split(".")
        assert name in {one.name for one in registry.installed(group)}, key
        assert extra in OPTIONAL, key


@pytest.mark.usefixtures("core_only")
def test_the_packages_of_an_extra_are_those_of_the_project_file() -> None:
    assert missing_packages("learning") == ("safetensors", "torch")
    assert set(missing_packages("photogrammetry")) == names(OPTIONAL["photogrammetry"])
    assert missing_packages("no_such_extra") == ()
    with pytest.raises(MissingExtraError, match=r'pip install "executive\[las\]"'):
        require_extra("a LAS file", "las")


@pytest.mark.usefixtures("core_only")
def test_a_plugin_without_its_extra_is_refused_with_another_that_does_without() -> None:
    with pytest.raises(MissingExtraError) as caught:
        registry.require_extras("grasping", "sampled_cnn")
    assert str(caught.value) == (
        "grasping plugin 'sampled_cnn' needs the extra 'learning' (not installed: safetensors, "
        'torch): pip install "executive[learning]"; or choose another: '
        "--set grasping.plugin=sampled_antipodal"
    )
    registry.require_extras("grasping", "sampled_antipodal")


@pytest.mark.usefixtures("core_only")
def test_a_mission_that_needs_it_ends_before_anything_moves(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    run_dir = tmp_path / "run"
    words = ["run", "pick_and_place", "--set", "robot.plugin=kinematic", "--run-dir", str(run_dir)]
    assert ended(monkeypatch, *words) == 2
    assert 'pip install "executive[' in capsys.readouterr().err
    assert not run_dir.exists()


@pytest.mark.usefixtures("core_only")
def test_the_list_names_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert ended(monkeypatch, "plugins", "list") == 0
    assert "sampled_antipodal, sampled_cnn (missing extra: learning)" in capsys.readouterr().out


@pytest.mark.usefixtures("core_only")
def test_the_doctor_does_not_call_it_broken(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert ended(monkeypatch, "plugins", "doctor", "--json") == 0
    found = {
        (one["capability"], one["name"]): one["missing_extra"]
        for one in json.loads(capsys.readouterr().out)
    }
    for key, extra in PROJECT["entry-points"]["executive.extra.v1"].items():
        assert found[tuple(key.split("."))] == extra
    assert found["grasping", "sampled_antipodal"] == ""
