"""Verbs apart from what they ask for: what they hand on, what they tell, and how they end."""

import json
import sys
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import typer

from executive.clouds.changes import Standing
from executive.commands import bulk
from executive.commands.clouds import changes as changes_verb
from executive.commands.grasps import grasp as grasp_verb
from executive.commands.grasps import scene
from executive.commands.logs import recorded_mission
from executive.commands.walls import place as place_verb
from executive.errors import ConfigError, DataError
from executive.messages.cloud import Cloud
from executive.messages.grasp import Grasp, GraspPlan
from executive.messages.segment import Segment, Segmentation
from executive.messages.stone import StoneState
from executive.tree.choices import Choices

GROUND = np.array([0.0, 0.0, 1.0, 0.0])


def segment(number: int, x: float) -> Segment:
    points = np.array([[x, 0.0, 0.3], [x, 0.4, 0.5]])
    return Segment(number, points, points.mean(axis=0), np.array([0.8, 0.4, 0.2]))


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


# --- grasp


@pytest.fixture
def segmenter(monkeypatch: pytest.MonkeyPatch) -> Plugin:
    plugin = Plugin(segmentation(0.0, 5.0))

    @contextmanager
    def chosen(interface: Any, choices: Any, model: Any = None) -> Any:
        plugin.asked.append((interface.__name__, model))
        yield plugin

    monkeypatch.setattr(scene, "chosen", chosen)
    monkeypatch.setattr(scene, "read_site", lambda path: np.ones((4, 3)))
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
            Path("in/site.ply"), 3, "my_method", ["grasping.x=1"], "m545", (1.0, 2.0, 3.0), out,
            picture, None, 9, True,
        )  # fmt: skip
    assert ended.value.exit_code == 0
    cloud, number, choices, machine, base = planned.read
    assert (cloud, number, machine, base) == (Path("in/site.ply"), 3, "m545", (1.0, 2.0, 3.0))
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
    _, number, _, machine, base = planned.read
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


# --- changes


def test_what_differs_is_told_and_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    came, went, old, now, unseen = (segment(n, float(n)) for n in range(5))
    T = np.eye(4)
    T[:3, 3] = [1.0, 2.0, 0.0]
    found = changes_verb._Found([came], [went], [(old, now, T)], [unseen], 7)
    compared: list[Any] = []

    def compare(*given: Any) -> Any:
        compared.append(given)
        return found

    monkeypatch.setattr(changes_verb, "_compared", compare)
    clouds = {Path("a.ply"): np.ones((1, 3)), Path("b.ply"): np.full((1, 3), 2.0)}
    monkeypatch.setattr("executive.clouds.reader.read_site", clouds.__getitem__)
    monkeypatch.setattr("executive.clouds.coordinate_system.coordinate_system", lambda path: "EPSG")
    guess = np.eye(4)
    guess[0, 3] = 10.0
    monkeypatch.setattr("executive.commands.clouds.guess.read_guess", lambda given: (guess, 3.0))
    written: list[Any] = []
    monkeypatch.setattr(
        "executive.clouds.ply_writer.write_parts", lambda *given: written.append(given)
    )
    out = tmp_path / "c.ply"
    changes_verb.changes(Path("a.ply"), Path("b.ply"), None, 0.05, ["a=b"], out, True)
    ((before, after, noise_m, set_),) = compared
    assert before.tolist() == [[1.0, 1.0, 1.0]]
    assert after.tolist() == [[16.0, 6.0, 6.0]]  # the scale first, then the pose
    assert (noise_m, set_) == (0.05, ["a=b"])
    ((path, parts, crs),) = written
    assert (path, crs) == (out, "EPSG")
    assert [part.tolist() for part in parts] == [one.points.tolist() for one in (came, went, now)]
    told = capsys.readouterr()
    assert told.err.splitlines() == [
        "  came    2 points at 0.00 0.20 0.40 m, 0.80 0.40 0.20 m long",
        "  went    2 points at 1.00 0.20 0.40 m, 0.80 0.40 0.20 m long",
        "  unseen  2 points at 4.00 0.20 0.40 m, 0.80 0.40 0.20 m long",
        "  moved   2 points at 2.00 0.20 0.40 m, 0.80 0.40 0.20 m long, to 3.00 2.20 0.40 m",
        "1 came, 1 went, 1 moved, 7 stayed, 1 unseen",
    ]
    answered = json.loads(told.out)
    assert (answered["stayed"], answered["crs"]) == (7, "EPSG")
    assert answered["moved"][0]["T"] == T.tolist()
    assert answered["moved"][0]["before"]["centroid"] == old.centroid.tolist()
    assert answered["moved"][0]["after"]["centroid"] == now.centroid.tolist()
    assert [len(answered[name]) for name in ("came", "went", "unseen")] == [1, 1, 1]
    assert answered["came"][0]["points"] == 2


def test_what_went_and_what_came_may_be_one_stone_that_has_moved(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of four old stones one stayed, one is not seen, one is gone and one lies elsewhere."""
    old, new = ([segment(n, float(n)) for n in range(first, first + 4)] for first in (0, 4))
    before, after = np.zeros((1, 3)), np.ones((1, 3))
    answers = {
        0: ("STAYED", "UNSEEN", "ABSENT", "ABSENT"),
        4: ("STAYED", "UNSEEN", "ABSENT", "ABSENT"),
    }
    asked: list[Any] = []

    def verdicts(clouds: Any, surface: Any, noise_m: float) -> Any:
        asked.append((surface, noise_m))
        first = int(clouds[0][0, 0])
        return [SimpleNamespace(standing=Standing[name]) for name in answers[first]]

    @contextmanager
    def chosen(interface: Any, choices: Any) -> Any:
        asked.append(interface.__name__)

        def segment_(cloud: Cloud) -> Any:
            return SimpleNamespace(segments=new if cloud.points.any() else old)

        yield SimpleNamespace(segment=segment_)

    monkeypatch.setattr("executive.commands.chosen.chosen", chosen)
    monkeypatch.setattr("executive.clouds.changes.verdicts", verdicts)
    monkeypatch.setattr("executive.clouds.changes.HeightMap", lambda cloud: cloud)
    monkeypatch.setattr("executive.clouds.changes.check_overlap", lambda *both: None)
    monkeypatch.setattr(
        changes_verb, "_moved", lambda registrar, went, came, cloud: [(went[1], came[0], np.eye(4))]
    )
    found = changes_verb._compared(before, after, 0.05, ())
    assert [one.id for one in found.came] == [7]
    assert [one.id for one in found.went] == [2]
    assert [(then.id, now.id) for then, now, _ in found.moved] == [(3, 6)]
    assert [one.id for one in found.unseen] == [1]
    assert found.stayed == 1
    assert asked == ["Segmenter", (after, 0.05), (before, 0.05), "Registrar"]
    answers[4] = ("STAYED",) * 4
    asked.clear()
    found = changes_verb._compared(before, after, 0.05, ())
    assert ([one.id for one in found.went], found.came, found.moved) == ([2, 3], [], [])
    assert "Registrar" not in asked  # nothing came that could be what went


class Registrar:
    """Finds a stone where a test says, in the cloud around what came."""

    def __init__(self, *answers: tuple[bool, float]) -> None:
        self.answers = list(answers)
        self.around: list[np.ndarray] = []

    def find(self, target: Cloud, source: Cloud) -> Any:
        self.around.append(target.points)
        accepted, x = self.answers.pop(0)
        T = np.eye(4)
        T[0, 3] = x
        return SimpleNamespace(accepted=accepted, T_target_source=T)


def test_a_stone_has_moved_where_it_is_found_near_what_came() -> None:
    old, far, near = segment(0, 0.0), segment(1, 4.0), segment(2, 8.0)
    after = np.array([[3.0, 0.0, 0.3], [2.99, 0.0, 0.3], [9.0, 1.4, 1.5], [9.0, 1.41, 0.3]])
    # At 4.41 m it is farther than half of the longest side, 0.4 m, from the middle of what came.
    registrar = Registrar((True, 4.41), (True, 8.39))
    ((then, now, T),) = changes_verb._moved(registrar, [old], [far, near], after)
    assert (then, now, T[0, 3]) == (old, near, 8.39)
    assert [around.tolist() for around in registrar.around] == [
        [[3.0, 0.0, 0.3]], [[9.0, 1.4, 1.5]]
    ]  # fmt: skip
    assert (
        changes_verb._moved(Registrar((False, 4.0), (False, 8.0)), [old], [far, near], after) == []
    )


def test_what_came_is_found_once_alone() -> None:
    one, two, came = segment(0, 0.0), segment(1, 1.0), segment(2, 4.0)
    registrar = Registrar((True, 4.0))
    pairs = changes_verb._moved(registrar, [one, two], [came], np.zeros((0, 3)))
    assert [(then, now) for then, now, _ in pairs] == [(one, came)]


# --- place


def test_a_trial_is_told_written_and_judged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    last = SimpleNamespace(detail="4 places slip")
    trial = SimpleNamespace(reason="nothing_fits", placed=["one"], last=last, built="the wall")
    asked: list[Any] = []

    def built(*given: Any) -> Any:
        asked.append(given)
        return trial, {"open.obj": "left out"}

    monkeypatch.setattr(place_verb, "_built", built)
    monkeypatch.setattr(
        "executive.commands.walls.construction.answer_of", lambda one: {"right": 1, "a": one.reason}
    )
    monkeypatch.setattr(
        "executive.commands.walls.judging.verdict_of", lambda one, name: {"stands": 0.5, "n": 3}
    )
    drawn: list[Any] = []

    def draw(*given: Any) -> list[str]:
        drawn.append(given)
        return ["course_1.png"]

    drawing = SimpleNamespace(draw_courses=draw)
    monkeypatch.setitem(sys.modules, "executive.commands.walls.pictures", drawing)
    out = tmp_path / "a.json"
    words = Path("stones"), Path("wall.yaml"), "mine", ["building.x=1"], 2.5, out, tmp_path
    with pytest.raises(typer.Exit) as ended:
        place_verb.place(*words, "a_judge", 5, True)
    assert ended.value.exit_code == 0
    ((stones, wall, options, budget, seed),) = asked
    assert (stones, wall, budget, seed) == (Path("stones"), Path("wall.yaml"), 2.5, 5)
    assert set(options) == {"building.x=1", "building.plugin=mine"}
    assert drawn == [(tmp_path, ["one"], 4)]
    told = capsys.readouterr()
    answered = {
        "seed": 5, "left_out": {"open.obj": "left out"}, "right": 1, "a": "nothing_fits",
        "verdict": {"stands": 0.5, "n": 3},
    }  # fmt: skip
    assert json.loads(told.out) == json.loads(out.read_text()) == answered
    assert told.err.splitlines() == [
        "ended: nothing_fits; 1 stones, 1 where planned",
        "  4 places slip",
        f"  {'stands':26} 0.500",
        f"  {'n':26} 3",
        "  course_1.png",
    ]
    drawn.clear()
    trial.placed, trial.last = [], None
    with pytest.raises(typer.Exit) as ended:
        place_verb.place(*words, "a_judge", 5, False)
    assert ended.value.exit_code == 1
    assert drawn == []
    told = capsys.readouterr()
    assert (told.out, told.err) == ("", "ended: nothing_fits; 0 stones, 1 where planned\n")
    assert "verdict" not in json.loads(out.read_text())


def test_pictures_need_a_folder_that_is_there(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"--pictures: .*none: name a folder that exists"):
        place_verb.place(Path("stones"), Path("wall.yaml"), pictures=tmp_path / "none")


# --- recorded missions


def test_the_truth_is_that_of_the_oracle() -> None:
    seen: list[Any] = []

    def truth(view: Any) -> Any:
        seen.append(view)
        return SimpleNamespace(estimate={"position_m": {"rms": 0.25}})

    recorded = recorded_mission.RecordedMission(Path("a"), SimpleNamespace(truth=truth), None)
    assert recorded.truth(["a state"]) == {"position_m": {"rms": 0.25}}
    (view,) = seen
    assert (view.states, view.stones, view.slots, view.attempts) == (["a state"], (), {}, ())


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """A mission that ticks twice; `robots` have an oracle each."""
    made = SimpleNamespace(robots=["kinematic"], oracles=[])
    settings = SimpleNamespace(datum=(47.0, 8.0, 440.0))
    plugins = {
        "robot": [SimpleNamespace(name="kinematic")],
        "estimation": [SimpleNamespace(settings=settings)],
    }
    made.description = SimpleNamespace(plugins=plugins)

    class Run:
        def __init__(self, description: Any, options: Any) -> None:
            made.options = options

        def execute(self, watch: Any) -> None:
            services = SimpleNamespace(plugins={"robot": "the robot"})
            for _ in range(2):
                watch(SimpleNamespace(services=services))

    def oracle(robot: str) -> str:
        made.oracles.append(robot)
        return f"oracle of {robot}"

    def load(mission: str, overrides: list[str]) -> Any:
        made.loaded = mission, overrides
        return made.description

    monkeypatch.setattr(recorded_mission, "Run", Run)
    monkeypatch.setattr(recorded_mission, "load_mission", load)
    monkeypatch.setattr(recorded_mission.registry, "names", lambda group: made.robots)
    monkeypatch.setattr(recorded_mission.registry, "load", lambda group, name: oracle)
    return made


def test_a_mission_is_recorded_with_its_oracle_and_the_origin_of_its_map(
    run: SimpleNamespace, tmp_path: Path
) -> None:
    found = recorded_mission.record_mission("relocate", ("a=1",), 4, tmp_path)
    assert run.loaded == ("relocate", ["a=1"])
    assert (run.options.seed, run.options.run_dir) == (4, tmp_path / "run")
    assert found.log == run.options.record_log == tmp_path / "recorded.mcap"
    assert (found.oracle, found.datum) == ("oracle of the robot", (47.0, 8.0, 440.0))
    assert run.oracles == ["the robot"]  # made once
    run.robots = []
    run.description.plugins["estimation"] = [SimpleNamespace(settings=object())]
    found = recorded_mission.record_mission("relocate", (), 4, tmp_path)
    assert (found.oracle, found.datum) == (None, None)


@pytest.mark.parametrize("has_oracle", [True, False])
@pytest.mark.parametrize("datum", [None, (47.0, 8.0, 440.0)])
def test_estimators_are_compared_from_the_origin_of_the_map(
    monkeypatch: pytest.MonkeyPatch, datum: Any, has_oracle: bool
) -> None:
    from dataclasses import dataclass

    @dataclass
    class Material:
        datum: Any

        @classmethod
        def read(cls, log: Path, options: Any) -> "Material":
            assert (log, options) == (Path("a.mcap"), "options")
            return cls(np.array([1.0, 2.0, 3.0]))

    compared: list[Any] = []

    def compare(*given: Any) -> str:
        compared.append(given)
        return "reports"

    monkeypatch.setattr(recorded_mission, "Material", Material)
    monkeypatch.setattr(recorded_mission, "compare", compare)
    oracle = SimpleNamespace() if has_oracle else None
    recorded = recorded_mission.RecordedMission(Path("a.mcap"), oracle, datum)
    assert recorded_mission.compare_on(recorded, ["one"], "options") == "reports"
    ((material, names, options, truth),) = compared
    assert material.datum.tolist() == list(datum or (1.0, 2.0, 3.0))
    assert (names, options) == (["one"], "options")
    assert truth == (recorded.truth if has_oracle else None)


# --- bulk work


@pytest.mark.parametrize(
    ("failing", "stopped", "status"), [([], "", 0), ([2], "", 1), ([], "Ctrl-C", 1)]
)
def test_bulk_work_hands_over_what_is_done_and_tells_what_failed(
    monkeypatch: pytest.MonkeyPatch, capsys: Any, failing: list[int], stopped: str, status: int
) -> None:
    from executive.campaign.trial import Outcome, Status

    asked: list[Any] = []

    def run(work: Any, scratch: Path, pool: Any, take: Any) -> Any:
        asked.append((work.work, dict(work.arguments), list(work.seeds), scratch, pool))
        for seed in work.seeds:
            is_bad = seed in failing
            state = Status.CRASHED if is_bad else Status.DONE
            outcome = Outcome(0, state, reason="torn" if is_bad else "")
            take(SimpleNamespace(seed=seed, folder=Path(str(seed)), outcome=outcome))
        return SimpleNamespace(stopped_by=stopped)

    monkeypatch.setattr("executive.campaign.bulk.run_bulk", run)
    monkeypatch.setattr(bulk, "pool_of", lambda *given: given)
    taken: list[Any] = []
    where = bulk.Where(Path("scratch"), jobs=3)
    told = bulk.spread("spread", {"a": 1}, [1, 2], where, lambda *given: taken.append(given))
    assert told == status
    assert asked == [("spread", {"a": 1}, [1, 2], Path("scratch"), (3, None))]
    assert taken == [(seed, Path(str(seed))) for seed in (1, 2) if seed not in failing]
    said = capsys.readouterr().err
    assert ("\nspread, seed 2: crashed: torn" in said) is bool(failing)
    assert ("\nstopped by Ctrl-C; the same command goes on" in said) is bool(stopped)
    cluster = bulk.Where(Path("scratch"), jobs=3, scheduler="tcp://s")
    bulk.spread("spread", {}, [], cluster, lambda *given: None)
    assert asked[-1][-1] == (None, "tcp://s")
