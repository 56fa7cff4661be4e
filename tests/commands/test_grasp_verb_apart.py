"""The verb `grasp` apart: what it hands on, what it tells and draws, and how it ends."""

import json
import sys
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import typer

from executive.commands.grasps import grasp as grasp_verb
from executive.commands.grasps import scene
from executive.errors import ConfigError, DataError
from executive.messages.cloud import Cloud
from executive.messages.grasp import Grasp, GraspPlan
from executive.messages.segment import Segmentation
from executive.messages.stone import StoneState
from executive.tree.choices import Choices
from tests.commands.segmented import segment

GROUND = np.array([0.0, 0.0, 1.0, 0.0])


def segmentation(*places: float) -> Segmentation:
    found = tuple(segment(n, x) for n, x in enumerate(places))
    return Segmentation("map", found, Cloud("map", np.zeros((1, 3))), GROUND)


class Plugin:
    """Answers with what it is given, and keeps what it is asked."""

    def __init__(self, answer: Any = None) -> None:
        self.answer = answer
        self.asked: list[tuple[str, Any]] = []

    def __getattr__(self, verb: str) -> Any:
        def call(*given: Any) -> Any:
            self.asked.append((verb, given))
            return self.answer

        return call


@pytest.fixture
def segmenter(monkeypatch: pytest.MonkeyPatch) -> Plugin:
    plugin = Plugin(segmentation(0.0, 5.0))

    @contextmanager
    def chosen(interface: Any, choices: Any, model: Any = None) -> Any:
        plugin.asked.append((interface.__name__, model))
        yield plugin

    monkeypatch.setattr(scene, "chosen", chosen)
    monkeypatch.setattr(scene, "read_site", lambda path, _: np.ones((4, 3)))
    return plugin


def test_the_scene_of_a_grasp_is_the_stone_on_the_ground_and_the_machine(segmenter: Plugin) -> None:
    choices = Choices(("segmentation",))
    found = scene.read_scene(Path("a.ply"), 1, choices, "m545", (1.0, 2.0, 90.0))
    wanted = segmentation(0.0, 5.0).segments[1]
    stone = found.stone
    assert (stone.id, stone.state) == (1, StoneState.ON_GROUND)
    np.testing.assert_array_equal(stone.points_map, wanted.points)
    np.testing.assert_allclose(found.T_map_base[:2, 3], [1.0, 2.0])
    np.testing.assert_allclose(found.T_map_base[:2, 0], [0.0, 1.0], atol=1e-12)  # it faces y
    assert (found.cloud.frame, found.cloud.points.shape) == ("map", (4, 3))
    assert (found.model, found.machine.name) == ("m545", found.machine.name)
    beside = scene.read_scene(Path("a.ply"), 1, choices, None, None)
    assert beside.model == choices.model
    away = np.linalg.norm(beside.T_map_base[:2, 3] - wanted.centroid[:2])
    assert away == pytest.approx(0.6 * beside.machine.reach_m)


@pytest.mark.parametrize(("places", "told"), [((0.0, 5.0), "0 to 1"), ((), "none")])
def test_a_segment_that_is_not_there_is_refused(
    segmenter: Plugin, places: tuple[float, ...], told: str
) -> None:
    segmenter.answer = segmentation(*places)
    with pytest.raises(DataError, match=f"no segment 2; there is {told}, as"):
        scene.read_scene(Path("a.ply"), 2, Choices(("segmentation",)), "m545", None)


def test_a_planner_is_asked_for_the_stone_in_its_cloud(segmenter: Plugin) -> None:
    choices = Choices(("segmentation", "grasping"))
    found = scene.read_scene(Path("a.ply"), 0, choices, "m545", None)
    segmenter.asked.clear()
    segmenter.answer, rng = "a plan", np.random.default_rng(0)
    assert scene.plan_grasps(found, rng) == "a plan"
    (who, (verb, given)) = segmenter.asked
    assert who == ("GraspPlanner", "m545")
    assert verb == "plan"
    assert given == (found.stone, found.cloud, found.T_map_base, rng)


@pytest.fixture
def planned(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """A verb `grasp` whose scene and plan are given, and what it was asked for."""
    made = SimpleNamespace(plan=GraspPlan((Grasp(np.eye(4), 2.0, 0.7, {}),), {"slips": 2}))
    made.scene = SimpleNamespace(
        T_map_base=np.eye(4),
        stone=SimpleNamespace(points_map=np.zeros((5, 3))),
        cloud=Cloud("map", np.ones((2, 3))),
        machine=SimpleNamespace(gripper="the gripper"),
        choices=None,
        model="m545",
    )

    def read(*given: Any) -> Any:
        made.read = given
        return made.scene

    def plan(found: Any, rng: np.random.Generator) -> GraspPlan:
        assert found is made.scene
        made.first_number = rng.integers(10**9)
        return made.plan

    monkeypatch.setattr("executive.tree.choices.Choices", lambda *given: given)
    monkeypatch.setattr("executive.commands.grasps.scene.read_scene", read)
    monkeypatch.setattr("executive.commands.grasps.scene.plan_grasps", plan)
    return made


def test_grasps_are_told_written_and_drawn(
    planned: SimpleNamespace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    drawn: list[Any] = []
    drawing = SimpleNamespace(draw_grasp=lambda *given: drawn.append(given))
    monkeypatch.setitem(sys.modules, "executive.commands.grasps.picture", drawing)
    out, picture = tmp_path / "a.json", tmp_path / "a.png"
    with pytest.raises(typer.Exit) as ended:
        grasp_verb.grasp(
            Path("in/site.ply"), 3, "my_method", 900.0, ["grasping.x=1"], "m545", (1.0, 2.0, 3.0),
            out, picture, None, 9, True,
        )  # fmt: skip
    assert ended.value.exit_code == 0
    cloud, number, choices, machine, base, widest_m = planned.read
    assert (cloud, number, machine, base) == (Path("in/site.ply"), 3, "m545", (1.0, 2.0, 3.0))
    assert widest_m == 900.0
    uses, options = choices
    assert uses == ("segmentation", "grasping")  # a viewer is needed for --record alone
    assert set(options) == {"grasping.x=1", "grasping.plugin=my_method"}
    assert planned.first_number == np.random.default_rng(9).integers(10**9)
    told = capsys.readouterr()
    assert "in/site.ply: 1 grasps of segment 3, 5 points\n" in told.err
    assert told.err.endswith("  refused    2 slips\n")
    assert json.loads(told.out) == json.loads(out.read_text())
    assert json.loads(told.out)["segment"] == 3
    (given,) = drawn
    assert (given[0], given[1]) == (picture, planned.plan.grasps[0])
    assert given[4:] == ("the gripper", "site.ply, segment 3: best of 1 grasps")


def test_a_stone_that_cannot_be_held_is_status_1_and_not_drawn(
    planned: SimpleNamespace, tmp_path: Path, capsys: Any
) -> None:
    planned.plan = GraspPlan((), {"slips": 2})
    with pytest.raises(typer.Exit) as ended:
        grasp_verb.grasp(Path("site.ply"), picture=tmp_path / "a.png")
    assert ended.value.exit_code == 1
    assert not (tmp_path / "a.png").exists()
    assert capsys.readouterr().out == ""
    _, number, _, machine, base, _ = planned.read
    assert (number, machine, base) == (0, None, None)
    assert planned.first_number == np.random.default_rng(1).integers(10**9)


@pytest.mark.parametrize(
    ("option", "name", "told"),
    [
        ("out", "a.txt", r"--out: .*a\.txt: name a \.json or \.yaml file"),
        ("picture", "a.json", r"--picture: .*a\.json: name a \.png file"),
        ("record", "a.png", r"--record: .*a\.png: name a \.rrd file"),
    ],
)
def test_a_file_of_another_kind_is_refused_before_anything_is_read(
    planned: SimpleNamespace, tmp_path: Path, option: str, name: str, told: str
) -> None:
    with pytest.raises(ConfigError, match=told):
        grasp_verb.grasp(Path("site.ply"), **{option: tmp_path / name})
    assert not hasattr(planned, "read")


def test_what_a_picture_needs_is_asked_for_and_a_recording_is_made(
    planned: SimpleNamespace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    needed: list[Any] = []
    recorded: list[Any] = []
    monkeypatch.setattr(grasp_verb, "require_extra", lambda *given: needed.append(given))
    monkeypatch.setattr(grasp_verb, "_record", lambda *given: recorded.append(given))
    drawing = SimpleNamespace(draw_grasp=lambda *given: None)
    monkeypatch.setitem(sys.modules, "executive.commands.grasps.picture", drawing)
    with pytest.raises(typer.Exit):
        grasp_verb.grasp(Path("site.ply"))
    assert (needed, recorded) == ([], [])
    with pytest.raises(typer.Exit):
        grasp_verb.grasp(Path("site.ply"), picture=tmp_path / "a.png")
    assert (needed, recorded) == ([("--picture", "viewing")], [])
    with pytest.raises(typer.Exit):
        grasp_verb.grasp(Path("site.ply"), record=tmp_path / "a.rrd")
    assert recorded == [(tmp_path / "a.rrd", planned.scene, planned.plan)]
    assert planned.read[2][0] == ("segmentation", "grasping", "viewing")


def test_a_recording_shows_a_grasp_each_second(
    planned: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
) -> None:
    viewer = Plugin()

    @contextmanager
    def chosen(*_: Any) -> Any:
        yield viewer

    monkeypatch.setattr("executive.commands.chosen.chosen", chosen)
    plan = SimpleNamespace(grasps=["best", "next"])
    grasp_verb._record(Path("a.rrd"), planned.scene, plan)
    assert viewer.asked == [
        ("open", ("a.rrd",)),
        ("show", (0.0, "map", planned.scene.cloud)),
        ("show", (0.0, "stones/1", planned.scene.stone)),
        ("show", (0.0, "grasp", "best")),
        ("show", (1.0, "grasp", "next")),
    ]
