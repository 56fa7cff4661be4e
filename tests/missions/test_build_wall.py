"""`build_wall` builds with the arm on what stands, and ends with a reason."""

import numpy as np
import pytest

pytestmark = pytest.mark.mission

WALL = """
structure: short wall
line: [[-4.8 m, 0.95 m], [-4.8 m, -0.95 m]]
thickness: 1.6 m
height: 0.8 m
building:
  plugin: dry_stone
  generator: {attitude: kept}
  check: {tries: 24}
"""
FEW = ("--set", "robot.site.stones.count=3")  # the fewest that the drone's map can be registered by


def run_wall(folder, command_line, text, *more):
    (folder / "wall.yaml").write_text(text)
    given = ("--wall", str(folder / "wall.yaml"), *FEW, *more, "--run-dir", str(folder / "run"))
    return command_line("run", "build_wall", "--seed", "21", *given)


def test_stones_are_set_down_where_the_building_planner_wants_them(
    tmp_path, command_line, read_run
):
    finished = read_run(tmp_path / "run", run_wall(tmp_path, command_line, WALL).status)
    assert (finished.exit_status, finished.report["outcome"]) == (0, "success")
    (ended,) = finished.report["structures"]
    assert (ended["structure"], ended["reason"]) == ("short wall", "nothing_fits")
    assert ended["standing"]
    kinds = ("building_planned", "slots_found", "stone_released")
    planned, places = {}, []
    released = set()
    for event in finished.events(*kinds):
        one = event["payload"]
        if event["kind"] == "building_planned":
            planned[one["stone"]] = one["T_map_object"]
        elif event["kind"] == "slots_found":
            places = [slot["slot"] for slot in one["slots"]]
        else:
            released.add(one["stone"])
            assert one["slot"] in places
            if one["slot"] == places[0]:  # the best place, unless no path leads there
                np.testing.assert_allclose(one["planned_pose"], planned[one["stone"]])
    assert set(ended["standing"]) == released <= set(planned)
    truth = finished.report["truth"]
    assert truth["collisions"] == []
    off = [one["slot_error_m"] for one in truth["stones"] if one["slot_error_m"] is not None]
    assert max(off) < 0.30
    (standing,) = truth["structures"]
    assert (standing["name"], len(standing["stones"])) == ("short wall", len(ended["standing"]))
    assert max(standing["moved_m"]) < 0.10
    assert standing["verdict"]["drift_20s_m"] < 0.05
    assert 0.0 < standing["verdict"]["fill"] < 1.0


def test_stones_that_are_all_too_heavy_end_it_without_a_wall(tmp_path, command_line, read_run):
    answer = run_wall(tmp_path, command_line, WALL + "  max_mass: 100 kg\n")
    finished = read_run(tmp_path / "run", answer.status)
    assert finished.exit_status == 1
    assert "all_too_heavy" in finished.report["reason"]
    (ended,) = finished.report["structures"]
    assert (ended["standing"], ended["refused"]) == ([], {"too_heavy": 3})
    assert finished.events("stone_grasped") == []
    bare = {"name": "short wall", "stones": [], "T_map_stones": [], "moved_m": [], "verdict": {}}
    assert finished.report["truth"]["structures"] == [bare]
    assert "it ended with all_too_heavy" in answer.err


def test_a_wall_with_a_mistake_is_refused_at_its_place(tmp_path, command_line):
    answer = run_wall(tmp_path, command_line, WALL.replace("thickness", "thiknes"))
    assert answer.status == 2
    assert "wall.yaml:4:1: error: a structure has no setting 'thiknes'" in answer.err


def test_a_mission_without_a_wall_takes_none(tmp_path, command_line):
    (tmp_path / "wall.yaml").write_text(WALL)
    answer = command_line("run", "map_site", "--wall", str(tmp_path / "wall.yaml"))
    assert answer.status == 2
    assert "has no tree 'the_wall' of its own to replace" in answer.err
