"""`executive grasp`: a stone of a cloud from a file, and the answer for people and for machines."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

from executive.clouds.ply_writer import write_parts
from executive.commands.grasps.answer import lines, plan_answer, write_answer
from executive.commands.grasps.machine_place import beside, standing
from executive.commands.grasps.picture import draw_grasp, touching_rad
from executive.commands.grasps.scene import read_scene
from executive.errors import ConfigError, DataError
from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud
from executive.messages.grasp import Grasp, GraspPlan
from executive.messages.segment import Segment, Segmentation
from executive.tree.choices import Choices

STONE_AT = np.array([4.0, 7.0])
GROUND_M = -0.4


def executive(*words: object) -> subprocess.CompletedProcess:
    code = (
        f"import sys; sys.argv = ['executive', *{[str(w) for w in words]!r}]; from "
        "executive.commands.main import main; main()"
    )
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)


@pytest.fixture(scope="module")
def cloud(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One slab on level ground that is not at zero."""
    rng = np.random.default_rng(0)
    ground = np.column_stack(
        [rng.uniform(-6, 6, (30_000, 2)) + STONE_AT, rng.normal(0, 0.005, 30_000)]
    )
    slab = rng.uniform((-0.6, -0.4, 0.0), (0.6, 0.4, 0.6), (8000, 3))
    face = rng.integers(0, 5, len(slab))  # all but the underside
    for i, (axis, value) in enumerate(((0, -0.6), (0, 0.6), (1, -0.4), (1, 0.4), (2, 0.6))):
        slab[face == i, axis] = value
    inside = (np.abs(ground[:, :2] - STONE_AT) < (0.6, 0.4)).all(axis=1)
    path = tmp_path_factory.mktemp("clouds") / "slab.ply"
    write_parts(path, [ground[~inside] + (0, 0, GROUND_M), slab + (*STONE_AT, GROUND_M)])
    return path


def test_the_best_grasp_is_told_written_drawn_and_recorded(cloud: Path, tmp_path: Path) -> None:
    out, picture, record = tmp_path / "grasps.yaml", tmp_path / "best.png", tmp_path / "best.rrd"
    ended = executive(
        "grasp", cloud, "--json", "--out", out, "--picture", picture, "--record", record
    )
    assert ended.returncode == 0, ended.stderr
    answered = json.loads(ended.stdout)
    assert yaml.safe_load(out.read_text()) == answered
    best = answered["grasps"][0]
    T = np.array(best["T_map_gripper"])
    np.testing.assert_allclose(T[:2, 3], STONE_AT, atol=0.3)
    np.testing.assert_allclose(best["approach"], T[:3, 0])
    assert {"opening_m", "score", "costs"} <= set(best)
    assert answered["refused"]["too_steep"] > 0
    assert f"{len(answered['grasps'])} grasps of segment 0" in ended.stderr
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert record.stat().st_size > 10_000


def test_out_of_reach_is_status_1_with_the_reason(cloud: Path) -> None:
    ended = executive(
        "grasp", cloud, "--base", -20, 7, 0, "--method", "sampled_antipodal", "--json"
    )
    assert ended.returncode == 1, ended.stderr
    assert json.loads(ended.stdout)["grasps"] == []
    assert json.loads(ended.stdout)["refused"]["out_of_reach"] > 0
    assert "out_of_reach" in ended.stderr


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--out", "grasps.txt"], "grasps.txt: name a .json or .yaml file"),
        (["--picture", "no/such/place.png"], "in a folder that exists"),
        (["--machine", "m54"], "no machine 'm54'"),
    ],
)
def test_wrong_options_are_a_message_and_status_2(cloud: Path, words: list[str], says: str) -> None:
    ended = executive("grasp", cloud, *words)
    assert ended.returncode == 2, ended.stderr
    assert says in ended.stderr
    assert "Traceback" not in ended.stderr


def test_a_segment_that_is_not_there_is_named_with_those_that_are(cloud: Path) -> None:
    with pytest.raises(DataError, match=r"slab\.ply: no segment 4; there is 0 to 0"):
        read_scene(cloud, 4, Choices(("segmentation",)), "m545", None)


def test_a_machine_that_is_none_is_refused(cloud: Path) -> None:
    with pytest.raises(ConfigError, match="no machine 'excavator'"):
        read_scene(cloud, 0, Choices(("segmentation",)), "excavator", None)


def segmentation(*places: tuple[float, float], slope: float = 0.0) -> Segmentation:
    normal = np.array([-slope, 0.0, 1.0]) / np.hypot(slope, 1.0)
    points = [np.array([[x, y, 0.3], [x, y, 0.4]]) for x, y in places]
    segments = tuple(Segment(i, p, p.mean(axis=0), np.ones(3)) for i, p in enumerate(points))
    return Segmentation(
        "map", segments, Cloud("map", np.zeros((1, 3))), np.array([*normal, GROUND_M])
    )


def test_the_machine_stands_at_a_share_of_its_reach_and_faces_the_stone() -> None:
    machine, found = load_machine("m545"), segmentation((4.0, 7.0))
    T = beside(found.segments[0], found, machine)
    toward = STONE_AT - T[:2, 3]
    assert np.linalg.norm(toward) == pytest.approx(0.6 * machine.reach_m)
    np.testing.assert_allclose(T[:2, 0], toward / np.linalg.norm(toward), atol=1e-9)
    assert T[2, 3] == pytest.approx(GROUND_M + machine.stance.base_height_m)


def test_the_machine_stands_away_from_neighbours() -> None:
    found = segmentation((0.0, 0.0), (5.0, 0.0), (4.0, 3.0))
    T = beside(found.segments[0], found, load_machine("m545"))
    assert min(np.linalg.norm(one.centroid[:2] - T[:2, 3]) for one in found.segments[1:]) > 8.0


def test_on_a_slope_the_machine_stands_at_the_height_of_its_place() -> None:
    machine = load_machine("m545")
    T = standing(10.0, 3.0, 0.5, segmentation((0.0, 0.0), slope=0.1), machine)
    assert T[2, 3] == pytest.approx(
        GROUND_M * np.hypot(0.1, 1.0) + 1.0 + machine.stance.base_height_m
    )
    assert np.arctan2(T[1, 0], T[0, 0]) == pytest.approx(0.5)


PLAN = GraspPlan((Grasp(np.eye(4), 2.0, 0.7, {"align_rad": 0.1}),), {"slips": 2, "too_steep": 30})


def test_reasons_come_with_their_counts_the_commonest_first() -> None:
    assert lines(PLAN)[-1] == "  refused    30 too_steep, 2 slips"
    assert lines(GraspPlan((), {}))[-1] == "  refused    nothing"


@pytest.mark.parametrize(("name", "read"), [("a.json", json.loads), ("a.yaml", yaml.safe_load)])
def test_an_answer_is_read_back_from_both_kinds_of_file(
    tmp_path: Path, name: str, read: object
) -> None:
    answered = plan_answer(PLAN, 0, np.eye(4))
    write_answer(tmp_path / name, answered)
    assert read((tmp_path / name).read_text()) == answered


def test_a_picture_without_any_point_near_is_still_drawn(tmp_path: Path) -> None:
    far = np.full((3, 3), 90.0)
    draw_grasp(tmp_path / "far.png", PLAN.grasps[0], far, far, load_machine("mini").gripper, "far")
    assert (tmp_path / "far.png").read_bytes().startswith(b"\x89PNG")


def test_the_jaws_of_a_picture_are_closed_on_the_stone() -> None:
    gripper = load_machine("m545").gripper
    wide_m, tip_m = 0.9, gripper.tips(0.5)[0][0]
    faces = [[tip_m, side * wide_m / 2, z] for side in (-1, 1) for z in np.linspace(-0.3, 0.3, 31)]
    angle_rad = touching_rad(gripper, np.array(faces), gripper.open_rad)
    left, right = gripper.tips(angle_rad)
    assert left[1] - right[1] == pytest.approx(wide_m, abs=0.2)
    assert touching_rad(gripper, np.array(faces) + (9.0, 0.0, 0.0), gripper.open_rad) == 0.0
