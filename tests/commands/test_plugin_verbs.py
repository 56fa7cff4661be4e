"""`plugins list`, `doctor` and `new` tell what is installed, broken and written."""

import json

import pytest

from executive import registry
from executive.commands.plugins import doctor
from executive.extras import MissingExtraError
from executive.testing import new_package
from tests.commands.in_process import executive


def finding(name, problem="", missing_extra=""):
    return {
        "capability": "alignment",
        "name": name,
        "target": f"mine:{name}",
        "problem": problem,
        "missing_extra": missing_extra,
    }


WELL = finding("fine")
BROKEN = finding("odd", "odd: no module 'x'")
MISSING = finding("learnt", "learnt: needs the extra 'learning'", "learning")


@pytest.mark.parametrize(
    ("findings", "status"),
    [([WELL], 0), ([WELL, MISSING], 0), ([WELL, BROKEN], 1), ([BROKEN, MISSING], 1), ([], 0)],
)
def test_the_doctor_tells_each_state_and_fails_for_what_is_broken(
    monkeypatch, capsys, findings, status
):
    monkeypatch.setattr(doctor, "diagnose", lambda: findings)
    assert executive(monkeypatch, "plugins", "doctor") == status
    lines = capsys.readouterr().out.splitlines()
    states = {"fine": "ok", "odd": "broken", "learnt": "missing extra: learning"}
    assert lines == [
        *[f"{states[one['name']]:29} alignment     {one['name']}" for one in findings],
        *[f"warning: {one['problem']}" for one in findings if one["problem"]],
    ]
    assert executive(monkeypatch, "plugins", "doctor", "--json") == status
    assert json.loads(capsys.readouterr().out) == findings


def test_the_doctor_says_why_something_cannot_be_imported(monkeypatch):
    def load(group, name):
        if name == "gicp":
            raise registry.BrokenPluginError("alignment", "gicp", ImportError("no module 'x'"))

    def require(group, name):
        if name == "fpfh":
            raise MissingExtraError(f"{group} {name}", "learning", ("torch",), "executive")

    asked = []
    monkeypatch.setattr(registry, "load", load)
    monkeypatch.setattr(registry, "require_extras", require)
    monkeypatch.setattr(registry, "load_verb", asked.append)
    monkeypatch.setattr(registry, "interface", asked.append)
    assert "no module 'x'" in doctor._problem("alignment", "gicp")
    assert "learning" in doctor._problem("registration", "fpfh")
    assert doctor._problem("alignment", "point_to_plane") == ""
    assert asked == []
    assert doctor._problem(registry.VERBS, "grasp-data") == ""
    assert doctor._problem(registry.INTERFACES, "alignment") == ""
    assert asked == ["grasp-data", "alignment"]


def test_plugins_are_listed_by_capability_for_people_and_for_programs(monkeypatch, capsys):
    assert executive(monkeypatch, "plugins", "list") == 0
    lines = capsys.readouterr().out.splitlines()
    assert executive(monkeypatch, "plugins", "list", "--json") == 0
    answer = json.loads(capsys.readouterr().out)
    assert [line.split()[0] for line in lines] == list(answer) == list(registry.capabilities())
    assert {"gicp", "point_to_plane"} <= set(answer["alignment"])
    (line,) = (line for line in lines if line.startswith("alignment "))
    assert line == f"{'alignment':13} {', '.join(answer['alignment'])}"


def test_a_new_package_is_told_file_by_file_with_what_comes_next(monkeypatch, capsys, tmp_path):
    asked = []
    files = [tmp_path / "steep" / "pyproject.toml", tmp_path / "steep" / "steep.py"]

    def write(*words):
        asked.append(words)
        return files

    monkeypatch.setattr(new_package, "new_package", write)
    words = ("plugins", "new", "segmentation", "steep", "--into", tmp_path)
    assert executive(monkeypatch, *words) == 0
    said = capsys.readouterr()
    assert said.err.splitlines() == [
        *[f"wrote {path}" for path in files],
        f"next: pip install -e {tmp_path / 'steep'}",
    ]
    assert said.out == ""
    assert executive(monkeypatch, *words, "--json") == 0
    assert json.loads(capsys.readouterr().out) == {"files": list(map(str, files))}
    assert asked == [("segmentation", "steep", tmp_path)] * 2
