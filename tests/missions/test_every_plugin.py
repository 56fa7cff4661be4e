"""Every shipped estimator, odometry, mapper, survey, registration, alignment and grasp planner is
part of a mission that sets a stone down; one run tries several at once. Each is run in a process of
its own, in which nothing else has compiled what it needs: no tick waits for a compiler.
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from executive_plugins.surveying.simulated_drone import SimulatedDrone

from executive.clouds.ply_writer import write_ply
from executive.mission.assembly import assemble
from executive.registry import installed
from executive.tree.load import load_mission

pytestmark = pytest.mark.mission

SCRIPT = Path(__file__).parents[1] / "late_compilation.py"
MISSION = Path(__file__).with_name("one_stone.yaml")
STONES = 3  # the fewest that a survey can be registered by
# What `pick_and_place` runs with stands in base.yaml; then all the others.
CHOICES: dict[str, dict[str, str]] = {
    "base": {},
    "graphs": {
        "estimation": "dual_graph",
        "odometry": "scan_to_submap",
        "mapping": "pose_graph",
        "registration": "segment_fpfh",
        "alignment": "point_to_plane",
        "grasping": "sampled_antipodal",
    },
    "filter": {
        "estimation": "error_state_ekf",
        "odometry": "kiss_icp",
        "surveying": "point_cloud_file",
        "registration": "kiss_matcher",
    },
}
CAPABILITIES = sorted({capability for chosen in CHOICES.values() for capability in chosen})


def test_no_shipped_plugin_is_left_out():
    base = load_mission("pick_and_place").plugins
    for capability in CAPABILITIES:
        shipped = {one.name for one in installed(capability) if one.distribution == "executive"}
        tried = {chosen[capability] for chosen in CHOICES.values() if capability in chosen}
        tried |= {chosen.name for chosen in base.get(capability, ())}
        # Photogrammetry takes minutes: tests/plugins/surveying runs it on a site of its own.
        assert shipped - {"colmap", "simulated_photographs"} == tried


@pytest.fixture(scope="module")
def drone_cloud(tmp_path_factory):
    """Write what a drone sees of the site that all these missions are on."""
    site = [f"robot.site.stones.count={STONES}", "robot.scenario=kind"]  # as the missions have it
    plugins = load_mission("pick_and_place", site).plugins
    made = assemble({name: plugins[name] for name in ("robot", "surveying")}, "m545", seed=1)
    made.start()
    survey = made.plugins["surveying"]
    assert isinstance(survey, SimulatedDrone)
    path = tmp_path_factory.mktemp("drone") / "drone.ply"
    cloud = survey.survey(np.random.default_rng(1))
    write_ply(path, cloud.points, cloud.frame)
    made.close()
    return path


@pytest.fixture(scope="module", params=CHOICES)
def ended(request, tmp_path_factory, drone_cloud, thin):
    """Run a mission with the chosen plugins; return its folder and what it compiled too late."""
    chosen = CHOICES[request.param]
    settings = [f"robot.site.stones.count={STONES}", *thin]
    settings += [f"{capability}.plugin={name}" for capability, name in chosen.items()]
    if chosen.get("surveying") == "point_cloud_file":
        # KISS-Matcher finds no motion between a survey and a map of every eighth return.
        settings += [f"surveying.path={drone_cloud}", "robot.sensors.azimuth_stride=4"]
    folder = tmp_path_factory.mktemp("mission") / "run"
    ended = subprocess.run(
        [sys.executable, SCRIPT, "mission", MISSION, folder, *settings],
        capture_output=True,
        text=True,
        timeout=800,
    )
    assert ended.returncode == 0, ended.stderr[-3000:]  # of a mission that is no success, it is 1
    return folder, json.loads(ended.stdout.splitlines()[-1])


@pytest.fixture(scope="module")
def finished(ended, read_run):
    return read_run(ended[0], 0)


def test_it_succeeds_with_the_plugins_that_were_chosen(finished):
    assert finished.report["outcome"] == "success"


def test_all_that_it_has_compiled_it_has_compiled_before_its_first_tick(ended):
    assert ended[1] == []


def test_the_estimator_keeps_the_cabin_to_centimetres(finished):
    assert finished.report["truth"]["estimate"]["error_m"]["max"] < 0.05


def test_the_survey_is_registered_and_the_stone_known_from_above(finished):
    assert finished.report["counts"]["registrations_accepted"] == 1


def test_one_stone_is_placed_and_seen_there(finished, check_truth):
    counts = finished.report["counts"]
    assert (counts["picks"], counts["placed"]) == (1, 1)
    # The look from the way up may be refused: then a scan of its own follows, and decides.
    looks = [event["payload"]["accepted"] for event in finished.events("stone_realigned")]
    assert looks in ([True], [False, True])
    check_truth(finished, placed=1)
