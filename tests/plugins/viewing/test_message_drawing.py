"""What is drawn of each message: where, how many points, how large, in which colour."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from executive_plugins.viewing.message_drawing import draw
from executive_plugins.viewing.palette import DRONE, GROUND, SLOT, STATES, of_number
from py_trees.common import Status

from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud
from executive.messages.mark import Mark
from executive.messages.region import Region
from executive.messages.status_change import StatusChange

M545 = load_machine("m545")
POINTS = np.random.default_rng(0).normal(0, 1, (1000, 3))


def drawn(value: object, entity: str, max_points: int = 1000) -> dict[str, dict[str, Any]]:
    """Return the components of each entity, by the last part of their names."""
    found = {}
    for path, components in draw(value, entity, M545.gripper, max_points):
        parts = {}
        for batch in components.as_component_batches():
            name = str(batch.component_descriptor()).rpartition(":")[2].strip()
            parts[name] = batch.as_arrow_array().to_pylist()
        found[str(path)] = parts
    return found


def colour(rgb: tuple[int, int, int]) -> int:
    r, g, b = rgb
    return (r << 24) + (g << 16) + (b << 8) + 255


def test_every_state_of_a_node_has_a_colour_of_its_own() -> None:
    assert set(STATES) == {*(status.name for status in Status), "SKIPPED"}
    assert len(set(STATES.values())) == len(STATES)


@pytest.mark.parametrize(("most", "count"), [(1001, 1000), (1000, 500), (333, 250)])
def test_a_cloud_of_the_map_is_thinned_and_coloured_by_height(most: int, count: int) -> None:
    ((path, parts),) = drawn(Cloud("map", POINTS), "map", most).items()
    assert path == "world/map"
    assert len(parts["positions"]) == count
    assert parts["radii"] == pytest.approx([0.015])
    assert len(set(parts["colors"])) > 50


def test_a_cloud_of_another_frame_stands_apart_and_a_drone_has_its_colour() -> None:
    ((path, parts),) = drawn(Cloud("survey", POINTS), "drone_cloud").items()
    assert path == "survey/drone_cloud"
    assert parts["colors"] == [colour(DRONE)]


def test_a_mark_is_a_point_with_its_text() -> None:
    parts = drawn(Mark("here", np.array([1.0, 2.0, 3.0])), "marks/1")
    point = parts["world/marks/1"]
    assert point["positions"] == [[1.0, 2.0, 3.0]]
    assert point["labels"] == ["here"]
    assert point["radii"] == pytest.approx([0.15])
    assert point["colors"] == [colour(SLOT)]
    assert parts["log/marks/1"]["text"] == ["marked: here"]


def test_a_region_is_a_closed_line_with_its_name() -> None:
    corners = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]])
    ((path, parts),) = drawn(Region("yard", corners), "regions/yard").items()
    assert path == "world/regions/yard"
    (strip,) = parts["strips"]
    assert strip == [[0, 0, 0], [4, 0, 0], [4, 3, 0], [0, 0, 0]]
    assert parts["labels"] == ["yard"]
    assert parts["radii"] == pytest.approx([0.03])


def test_what_is_not_known_is_not_drawn() -> None:
    assert drawn("a text", "anything") == {}


def test_numbers_that_follow_each_other_have_colours_that_differ() -> None:
    colours = np.array([of_number(k) for k in range(6)], dtype=float)
    apart = [np.linalg.norm(a - b) for a, b in pairwise(colours)]
    assert min(apart) > 100
    assert of_number(3) == of_number(3)
    assert max(max(one) for one in colours) == pytest.approx(0.95 * 255, abs=1)
    assert GROUND not in {tuple(one) for one in colours}


@pytest.mark.parametrize(("after", "level"), [("GLOBAL", "INFO"), ("FALLBACK", "WARN")])
def test_a_loss_of_the_estimate_is_logged_as_a_warning_with_its_reason(
    after: str, level: str
) -> None:
    parts = drawn(StatusChange(1.0, "SUSPECT", after, "no fix for 1.0 s"), "estimator")
    (entry,) = parts["log/estimator"]["text"]
    assert entry == f"estimator: SUSPECT → {after}: no fix for 1.0 s"
    assert parts["log/estimator"]["level"] == [level]
    bare = drawn(StatusChange(1.0, "SUSPECT", after, ""), "estimator")
    assert bare["log/estimator"]["text"] == [f"estimator: SUSPECT → {after}"]
