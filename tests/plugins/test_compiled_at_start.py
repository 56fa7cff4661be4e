"""What a plugin has compiled, it has compiled when it has started: no verb waits for a compiler."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from executive import registry
from executive.clouds.ply_writer import write_parts
from executive.testing.exercises.segmentation import site

SCRIPT = Path(__file__).parents[1] / "late_compilation.py"
# Fewer stones and grasps cost less; what is compiled is the same.
SETTINGS = {
    ("robot", "mujoco"): ("robot.site.stones.count=1",),
    ("grasping", "sampled_antipodal"): ("grasping.samples=60",),
    ("grasping", "sampled_cnn"): ("grasping.samples=60", "grasping.rehearsed=1"),
}
# Photogrammetry takes minutes, in a process of its own, and a machine behind the wire computes
# elsewhere.
ELSEWHERE = {("surveying", "colmap"), ("surveying", "simulated_photographs"), ("robot", "wire")}
PLUGINS = [
    (capability, one.name)
    for capability in registry.capabilities()
    for one in registry.installed(capability)
    if one.distribution == "executive" and (capability, one.name) not in ELSEWHERE
]


@pytest.mark.parametrize(("capability", "name"), PLUGINS)
def test_no_verb_of_a_shipped_plugin_waits_for_a_compiler(capability, name, tmp_path):
    settings = SETTINGS.get((capability, name), ())
    if name == "point_cloud_file":
        write_parts(tmp_path / "site.ply", [site()])
        settings = (f"surveying.path={tmp_path / 'site.ply'}",)
    ended = subprocess.run(
        [sys.executable, SCRIPT, "plugin", capability, name, *settings],
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert ended.returncode == 0, ended.stderr[-3000:]
    assert json.loads(ended.stdout.splitlines()[-1]) == []
