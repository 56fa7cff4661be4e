"""What stands in a recording, read back from the file."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from executive_plugins.viewing.rerun import RerunViewer
from executive_plugins.viewing.settings import RerunSettings
from rerun.chunk import RrdReader

from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.machine.kinematics import Kinematics
from executive.machine.machine import Machine, load_machine
from executive.messages.base_state import BaseState
from executive.messages.cloud import Cloud
from executive.messages.grasp import Grasp
from executive.messages.joints import JointSample
from executive.messages.region import Region
from executive.messages.status_change import StatusChange

# Rows of one entity: seconds of mission, and the values of one component.
Rows = Callable[[str, str], list[tuple[float, list]]]


@pytest.fixture(scope="module")
def machine() -> Machine:
    return load_machine("m545")


@pytest.fixture
def viewer(machine: Machine, tmp_path: Path) -> RerunViewer:
    viewer = RerunViewer(RerunSettings(max_points=1000), machine)
    viewer.start()
    viewer.open(str(tmp_path / "recording.rrd"))
    return viewer


@pytest.fixture
def rows(viewer: RerunViewer, tmp_path: Path) -> Rows:
    """Close the recording and read one component of one entity."""

    def rows(entity: str, component: str) -> list[tuple[float, list]]:
        viewer.close()
        found = []
        for chunk in RrdReader(str(tmp_path / "recording.rrd")).stream():
            batch = chunk.to_record_batch()
            if (
                chunk.entity_path == entity
                and component in batch.schema.names
                and not chunk.is_static
            ):
                stamps = batch["mission"].cast("int64").to_numpy() / 1e9
                found += zip(stamps, batch[component].to_pylist(), strict=True)
        return sorted(found, key=lambda row: row[0])

    return rows


def state_and_joints(machine: Machine, T_map_base: np.ndarray, arm: np.ndarray, t: float):
    T_map_cabin = T_map_base @ Kinematics(machine).frames(arm)[machine.cabin_link]
    state = BaseState(
        t, T_map_base, T_map_base, T_map_cabin, np.zeros(3), np.zeros(3), np.eye(6), "GLOBAL"
    )
    n = len(machine.joint_names)
    effort = np.append([0.5 * joint.max_effort for joint in machine.joints], 0.0)
    return state, JointSample(t, machine.joint_names, np.append(arm, 0.3), np.zeros(n), effort)


def test_links_stand_where_kinematics_and_state_put_them(
    viewer: RerunViewer, machine: Machine, rows: Rows
) -> None:
    T_map_base = pose(from_rpy(0.05, -0.02, 1.0), np.array([3.0, 4.0, 0.5]))
    arm = machine.posture("carry")
    state, joints = state_and_joints(machine, T_map_base, arm, 2.0)
    viewer.show(2.0, "state", state)
    viewer.show(2.0, "joints", joints)
    frames = Kinematics(machine).frames(arm, 0.3)
    for link in ("base", "boom", "jaw_left"):
        rows_of_link = rows(f"/world/machine/{link}", "Transform3D:translation")
        assert [stamp for stamp, _ in rows_of_link] == [2.0]
        np.testing.assert_allclose(
            rows_of_link[0][1][0], (T_map_base @ frames[link])[:3, 3], atol=1e-5
        )


def test_the_machine_is_drawn_at_its_own_pace(
    viewer: RerunViewer, machine: Machine, rows: Rows
) -> None:
    for k in range(100):
        state, joints = state_and_joints(machine, np.eye(4), machine.posture("scan"), k / 100)
        viewer.show(k / 100, "state", state)
        viewer.show(k / 100, "joints", joints)
    assert len(rows("/world/machine/boom", "Transform3D:translation")) == 10
    assert rows("/plots/effort/J_BOOM", "Scalars:scalars")[0][1] == [pytest.approx(0.5)]


def test_an_unknown_pose_is_not_drawn_but_joints_are_plotted(
    viewer: RerunViewer, machine: Machine, rows: Rows
) -> None:
    _, joints = state_and_joints(machine, np.eye(4), machine.posture("scan"), 0.0)
    viewer.show(0.0, "joints", joints)
    assert rows("/world/machine/boom", "Transform3D:translation") == []
    assert rows("/plots/jaw/J_JAW", "Scalars:scalars")[0][1] == [pytest.approx(0.3)]


def test_a_large_cloud_is_thinned_evenly(viewer: RerunViewer, rows: Rows) -> None:
    points = np.c_[np.linspace(0, 1, 5000), np.zeros((5000, 2))]
    viewer.show(1.0, "map", Cloud("map", points))
    drawn = np.array(rows("/world/map", "Points3D:positions")[0][1])
    assert 500 < len(drawn) <= 1000
    np.testing.assert_allclose([drawn[0, 0], drawn[-1, 0]], [0, 1], atol=2e-3)


def test_a_cloud_of_its_own_frame_is_kept_apart_from_the_site(
    viewer: RerunViewer, rows: Rows
) -> None:
    viewer.show(1.0, "survey", Cloud("drone", np.ones((10, 3))))
    assert rows("/world/survey", "Points3D:positions") == []
    assert len(rows("/survey/survey", "Points3D:positions")) == 1


def test_a_region_is_drawn_as_a_closed_outline(viewer: RerunViewer, rows: Rows) -> None:
    corners = np.array([[1.0, 0.0], [3.0, 0.0], [3.0, 2.0]])
    viewer.show(0.0, "regions/yard", Region("yard", corners))
    ((_, (outline,)),) = rows("/world/regions/yard", "LineStrips3D:strips")
    np.testing.assert_allclose(np.array(outline)[:, :2], [*corners, corners[0]])
    assert rows("/world/regions/yard", "LineStrips3D:labels")[0][1] == ["yard"]


def test_the_chosen_grasp_is_posed(viewer: RerunViewer, rows: Rows) -> None:
    T = pose(from_rpy(0, np.pi / 2, 0), np.array([5.0, 1.0, 2.0]))
    viewer.show(4.0, "grasp", Grasp(T, 1.5, 0.7, {"align_rad": 0.1}))
    stamp_s, translation = rows("/world/grasp", "Transform3D:translation")[0]
    assert stamp_s == 4.0
    np.testing.assert_allclose(translation[0], [5, 1, 2])


def test_only_changes_of_the_tree_are_written(viewer: RerunViewer, rows: Rows) -> None:
    for k, status in enumerate(["RUNNING", "RUNNING", "SUCCESS"]):
        viewer.show(float(k), "tree", {"main": "RUNNING", "main/Segment": status})
    assert rows("/states/main/Segment", "StateChange:state") == [
        (0.0, ["RUNNING"]),
        (2.0, ["SUCCESS"]),
    ]
    assert [text for _, (text,) in rows("/tree", "TextDocument:text")][
        -1
    ] == "main: RUNNING\n  Segment: SUCCESS"


def test_a_lane_of_its_own_tells_which_leaf_runs(viewer: RerunViewer, rows: Rows) -> None:
    for k, leaf in enumerate(["0:ScanSwing", "1:Segment"]):
        states = {
            "main": "RUNNING",
            "main/0:ScanSwing": "SUCCESS",
            "main/1:Segment": "INVALID",
            f"main/{leaf}": "RUNNING",
        }
        viewer.show(float(k), "tree", states)
    assert rows("/states/leaf", "StateChange:state") == [(0.0, ["ScanSwing"]), (1.0, ["Segment"])]


def test_nothing_is_written_before_it_is_opened(machine: Machine) -> None:
    viewer = RerunViewer(RerunSettings(), machine)
    viewer.show(0.0, "map", Cloud("map", np.zeros((3, 3))))
    viewer.close()


def test_how_the_estimator_stands_has_a_lane_and_its_reasons_are_in_the_log(
    viewer: RerunViewer, rows: Rows
) -> None:
    viewer.show(3.0, "estimator", StatusChange(2.9, "INITIALISING", "GLOBAL", ""))
    viewer.show(5.0, "estimator", StatusChange(4.9, "GLOBAL", "SUSPECT", "no fix for 0.7 s"))
    lane = rows("/states/estimator", "StateChange:state")
    assert [(t, *state) for t, state in lane if state] == [(3.0, "GLOBAL"), (5.0, "SUSPECT")]
    log = rows("/log/estimator", "TextLog:text")
    assert [text for _, (text,) in log] == [
        "estimator: INITIALISING → GLOBAL",
        "estimator: GLOBAL → SUSPECT: no fix for 0.7 s",
    ]
