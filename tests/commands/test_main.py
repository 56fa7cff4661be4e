"""The command line is light, tells mistakes without tracebacks, and ends with the right status."""

import json
import subprocess
import sys
from importlib import metadata

import pytest
from typer.main import get_command

from executive.commands.main import app


def python(code, *, cwd=None):
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120, cwd=cwd
    )


def executive(*words, cwd=None):
    code = (
        f"import sys; sys.argv = ['executive', *{list(words)!r}]; from "
        "executive.commands.main import main; main()"
    )
    return python(code, cwd=cwd)


def test_lists_every_capability():
    table = json.loads(executive("plugins", "list", "--json").stdout)
    assert table["registration"] == ["kiss_matcher", "segment_fpfh", "segment_shot"]
    assert all(table.values())


def test_shows_a_plugins_settings():
    shown = json.loads(executive("plugins", "show", "alignment", "gicp", "--json").stdout)
    assert shown["distribution"] == "executive"
    assert shown["settings"]


def test_the_doctor_finds_all_well():
    assert executive("plugins", "doctor").returncode == 0


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["run", "no_such_mission"], "no_such_mission"),
        (["check", "no_such_file.yaml"], "no_such_file.yaml"),
        (
            ["plugins", "show", "alignment", "gicpp"],
            "no alignment plugin 'gicpp'. Did you mean 'gicp'?",
        ),
        (["show", "map_site", "--as", "png"], "--as: 'png' is not one of text, dot, xml"),
        (["run", "map_site", "--runner", "tread"], "Did you mean 'thread'?"),
        (["run", "map_site", "--answer", "maybe"], "--answer"),
        (["run", "map_site", "--set", "robot.model=m454"], "m545"),
        (["run", "map_site", "--set", "robot.sitee.stones.count=3"], "robot.sitee"),
        (["run", "map_site", "--set", "robot.plugin=mujocco"], "mujoco"),
        (["frobnicate"], "frobnicate"),
    ],
)
def test_wrong_input_is_a_message_and_status_2(words, says, tmp_path):
    ended = executive(*words, cwd=tmp_path)
    assert ended.returncode == 2
    assert says in ended.stderr
    assert "Traceback" not in ended.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_run_folder_is_not_used_twice(tmp_path):
    (tmp_path / "journal.jsonl").write_text("")
    ended = executive("run", "map_site", "--run-dir", str(tmp_path), "--quiet")
    assert ended.returncode == 2
    assert "holds a run already" in ended.stderr


def test_shows_a_whole_mission_for_machines(tmp_path):
    shown = json.loads(
        executive(
            "show", "map_site", "--json", "--set", "robot.site.stones.count=3", cwd=tmp_path
        ).stdout
    )
    assert shown["plugins"]["robot"]["site"]["stones"]["count"] == 3
    assert set(shown["trees"]) == {"main", "map_and_segment", "scan_first"}


def test_prints_its_version():
    assert executive("--version").stdout == f"executive {metadata.version('executive')}\n"


COMPLETIONS = {
    "executive compare-": "compare-estimators",
    "executive grasp-d": "grasp-data",
    "executive plugins doc": "doctor",
    "executive segment --js": "--json",
}


def test_bash_completes_verbs_and_options():
    code = f"""
import os, sys
from executive.commands.main import main
os.environ["_EXECUTIVE_COMPLETE"] = "complete_bash"
for typed in {list(COMPLETIONS)!r}:
    os.environ.update(COMP_WORDS=typed, COMP_CWORD=str(typed.count(" ")))
    sys.argv = ["executive"]
    try:
        main()
    except SystemExit as end:
        assert not end.code, end.code
"""
    assert python(code).stdout.split() == list(COMPLETIONS.values())


def test_every_verb_has_a_summary_that_fits_and_an_example():
    top = get_command(app)
    context = top.make_context("executive", [], resilient_parsing=True)
    verbs = {name: top.get_command(context, name) for name in top.list_commands(context)}
    inner = verbs.pop("plugins")
    verbs |= {f"plugins {name}": verb for name, verb in inner.commands.items()}
    assert len(verbs) > 15
    for name, verb in verbs.items():
        assert len(verb.help.partition("\n")[0]) <= 48, name  # what `executive --help` has room for
        assert f"Example: executive {name}" in verb.help, name
