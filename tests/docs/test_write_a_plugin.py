"""The page on writing a plugin is true: its files, installed as it says, work with its commands."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

PAGE = Path(__file__).parents[2] / "docs" / "write_a_plugin.md"
MISSION = """\
api: 1
mission: my_mission
extends: map_site
plugins:
  monitoring: [jaw_slip, {plugin: boom_watch, fall: 0.5}]
"""


def block(language, containing):
    found = [
        b
        for b in re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(), re.S)
        if containing in b
    ]
    assert len(found) == 1, f"one {language} block with '{containing}'"
    return found[0]


def command(*words, site, cwd):
    environment = {**os.environ, "PYTHONPATH": str(site)}
    executive = Path(sys.executable).with_name("executive")
    return subprocess.run(
        [executive, *words], env=environment, cwd=cwd, capture_output=True, text=True, timeout=120
    )


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """A folder into which the page's package is installed."""
    source = tmp_path_factory.mktemp("boom-watch")
    (source / "boom_watch.py").write_text(block("python", "class BoomWatch"))
    (source / "pyproject.toml").write_text(block("toml", "boom_watch:BoomWatch"))
    target = tmp_path_factory.mktemp("site")
    install = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--no-deps",
        "--target",
        str(target),
        str(source),
    ]
    subprocess.run(install, check=True, timeout=120)
    return target


def test_the_class_of_the_page_reports_a_fall_of_the_torque_once_and_while_holding_alone():
    names = {}
    exec(block("python", "class BoomWatch"), names)
    watch = names["BoomWatch"](names["BoomWatchSettings"](fall=0.4))

    def at(torque_n_m):
        values = (("J_BOOM",), np.zeros(1), np.zeros(1), np.array([torque_n_m]))
        return watch.update(names["JointSample"](1.0, *values))

    assert at(9e4) is None
    watch.begin_hold()
    assert [at(-1e5), at(-7e4)] == [None, None]
    assert at(-5e4).trouble is names["Trouble"].DROP
    assert at(-1e3) is None


def test_the_plugin_is_listed(site, tmp_path):
    listed = command("plugins", "list", site=site, cwd=tmp_path)
    assert re.search(r"monitoring .*boom_watch", listed.stdout)


def test_the_plugin_shows_its_settings(site, tmp_path):
    shown = command("plugins", "show", "monitoring", "boom_watch", site=site, cwd=tmp_path)
    assert "Lost share of the torque" in shown.stdout


def test_the_doctor_finds_nothing_wrong(site, tmp_path):
    assert command("plugins", "doctor", site=site, cwd=tmp_path).returncode == 0


def test_a_mission_selects_it(site, tmp_path):
    (tmp_path / "my_mission.yaml").write_text(MISSION)
    assert "{plugin: boom_watch, fall: 0.5}" in PAGE.read_text()
    assert command("check", "my_mission.yaml", site=site, cwd=tmp_path).returncode == 0


def test_its_settings_are_checked_with_their_place(site, tmp_path):
    (tmp_path / "my_mission.yaml").write_text(MISSION.replace("fall: 0.5", "fall: 5"))
    refused = command("check", "my_mission.yaml", site=site, cwd=tmp_path)
    assert refused.returncode == 2
    assert "my_mission.yaml:5:" in refused.stderr


@pytest.mark.slow
def test_it_keeps_its_contract(site, tmp_path):
    held = command("plugins", "test", "monitoring", "boom_watch", site=site, cwd=tmp_path)
    assert held.returncode == 0, held.stdout
    assert "executive plugins test monitoring boom_watch" in PAGE.read_text()


def test_a_new_package_is_written(site, tmp_path):
    words = re.search(r"executive (plugins new .*)", PAGE.read_text()).group(1).split()
    assert command(*words, site=site, cwd=tmp_path).returncode == 0
    assert (tmp_path / "steep_ground" / "pyproject.toml").is_file()


def test_the_bulk_work_of_the_page_answers_the_same_for_a_seed(tmp_path):
    names = {}
    exec(block("python", "class Weigh(Work)"), names)
    arguments = names["WeighSettings"](samples=3)
    answers = []
    for folder in (tmp_path / "a", tmp_path / "b"):
        folder.mkdir()
        answers.append(names["Weigh"]().run(names["Piece"](arguments, 5, folder, {})))
        assert (folder / "weights.npy").exists()
    assert answers[0] == answers[1]
    assert len(answers[0]["measurements"]["weight"]["values"]) == 3
    assert names["Weigh"]().inputs(names["WeighSettings"](stones=tmp_path)) == {"stones": tmp_path}
