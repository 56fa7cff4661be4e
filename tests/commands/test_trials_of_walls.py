"""Trials of walls, part by part: the loop, its answer, the pictures and the folder of stones."""

import math
import re
import time
from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from executive.commands.walls import pictures, place
from executive.commands.walls.construction import PlacedStone, Trial, TrialRules, answer_of, build
from executive.commands.walls.stone_folder import read_stones
from executive.commands.walls.structure_file import StoneChoice
from executive.errors import ConfigError
from executive.geometry.pose import pose
from executive.interfaces.trial_site import Settled
from executive.messages.building import AsBuilt, BuildPlan, BuildTarget, StandingStone
from executive.testing.exercises.building import bare, box, boxes

RELEASED, EXPECTED = pose(t=np.array([0.0, 0.0, 0.5])), pose(t=np.array([0.0, 0.0, 0.2]))


def turned(angle_rad: float, t: tuple[float, float, float]) -> np.ndarray:
    T = pose(t=np.array(t))
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    T[:2, :2] = [[c, -s], [s, c]]
    return T


def target(stone: str, *, is_best: bool = True) -> BuildTarget:
    down = np.array([0.0, 0.0, -1.0])
    if not is_best:
        return BuildTarget(stone, np.eye(4), np.eye(4), down, 0.0, 1.0, 2.0, 0.1, {})
    return BuildTarget(stone, RELEASED, EXPECTED, down, 0.1, 0.02, 0.03, 1.5, {"gap": 0.7})


def targets(stone: str) -> tuple[BuildTarget, ...]:
    return target(stone), target("other", is_best=False)


class Planner:
    """Takes the stones in the order of their names, up to a number."""

    def __init__(self, most: int) -> None:
        self.most = most
        self.asked: list[tuple[int, tuple[str, ...]]] = []
        self.may_go_on = None

    def propose(self, built, inventory, rng, may_go_on) -> BuildPlan:
        self.asked.append((len(built.standing), tuple(stone.name for stone in inventory)))
        self.may_go_on = may_go_on
        if len(self.asked) > self.most:
            return BuildPlan((), "nothing_fits", {"slips": 4}, "4 places slip")
        return BuildPlan(targets(inventory[0].name), None, {"too_high": 2})


class Site:
    """Lets each stone settle 3 cm and 4 cm off its plan, turned by 0.1, and moves the others."""

    def __init__(self) -> None:
        self.noise: list[tuple[float, float]] = []

    def place(self, built, stone, T_map_stone, noise, rng) -> Settled:
        np.testing.assert_array_equal(T_map_stone, RELEASED)
        self.noise.append(noise)
        before = [turned(0.0, (9.0, 9.0, float(k))) for k in range(len(built.standing))]
        return Settled([*before, turned(0.1, (0.03, 0.04, 0.2))], 0.25, True)


def built_with(planner: Planner, rules: TrialRules) -> tuple[Trial, Site, list[str]]:
    site, seen = Site(), []
    rng = np.random.default_rng(0)
    told = lambda one: seen.append(one.stone)
    return build(bare(), boxes(), planner, site, rules, rng, told), site, seen


def test_stones_are_placed_one_by_one_until_there_is_no_target(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = count(100.0, 0.5)
    monkeypatch.setattr(time, "process_time", lambda: next(clock))
    planner = Planner(2)
    trial, site, seen = built_with(planner, TrialRules((0.03, 0.035), 10))
    names = ("box_0", "box_1", "box_2", "box_3")
    assert planner.asked == [(0, names), (1, names[1:]), (2, names[2:])]
    assert (trial.reason, trial.last.detail) == ("nothing_fits", "4 places slip")
    assert seen == [one.stone for one in trial.placed] == ["box_0", "box_1"]
    assert site.noise == [(0.03, 0.035)] * 2
    first, second = trial.placed
    assert first.error_m == pytest.approx(0.05)
    assert first.error_rad == pytest.approx(0.1)
    assert (first.moved_m, first.is_right) == (0.25, True)
    assert second.planning_cpu_s == 0.5
    assert trial.built is second.built
    where = [one.T_map_stone[:3, 3].tolist() for one in trial.built.standing]
    assert where == [[9.0, 9.0, 0.0], [0.03, 0.04, 0.2]]  # the first was moved by the second
    assert [one.stone.name for one in trial.built.standing] == ["box_0", "box_1"]


def test_a_trial_ends_with_the_most_stones() -> None:
    trial, _, seen = built_with(Planner(9), TrialRules((0.0, 0.0), 3))
    assert (trial.reason, trial.last, len(seen)) == ("most_stones", None, 3)


def test_a_plan_may_take_its_budget_of_processor_time(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [5.0]
    monkeypatch.setattr(time, "process_time", lambda: clock[0])
    planner = Planner(9)
    built_with(planner, TrialRules((0.0, 0.0), 1, budget_s=2.0))
    clock[0] = 6.9
    assert planner.may_go_on()
    clock[0] = 7.0
    assert not planner.may_go_on()
    built_with(planner, TrialRules((0.0, 0.0), 1))
    clock[0] = 1e6
    assert planner.may_go_on()


def placed(error_m: float, error_rad: float) -> PlacedStone:
    plan = BuildPlan(targets("box_0"), None, {"too_high": 2})
    return PlacedStone("box_0", plan, bare(), error_m, error_rad, 0.25, 1.5)


@pytest.mark.parametrize(
    ("error_m", "error_deg", "is_right"),
    [(0.1, 9.9, True), (0.101, 1.0, False), (0.02, 10.1, False), (0.0, 0.0, True)],
)
def test_a_stone_is_right_within_10_cm_and_10_degrees(error_m, error_deg, is_right) -> None:
    assert placed(error_m, math.radians(error_deg)).is_right is is_right


def test_the_answer_is_the_trial_in_plain_values() -> None:
    standing = bare().with_standing(StandingStone(boxes()[0], EXPECTED))
    nothing = BuildPlan((), "nothing_fits", {"slips": 4}, "4 places slip")
    told = answer_of(
        Trial(standing, [placed(0.05, 0.1), placed(0.5, 0.1)], "nothing_fits", nothing)
    )
    assert told.pop("placed") == [
        {
            "stone": "box_0",
            "T_map_stone": RELEASED.tolist(),
            "T_map_settled": EXPECTED.tolist(),
            "worst_m": 0.02,
            "worst_rad": 0.03,
            "score": 1.5,
            "terms": {"gap": 0.7},
            "refused": {"too_high": 2},
            "error_m": error_m,
            "error_rad": 0.1,
            "moved_others_m": 0.25,
            "planning_cpu_s": 1.5,
            "is_right": is_right,
        }
        for error_m, is_right in ((0.05, True), (0.5, False))
    ]
    assert told == {
        "structure": "wall",
        "ended": "nothing_fits",
        "detail": "4 places slip",
        "refused_at_the_end": {"slips": 4},
        "right": 1,
        "standing": [{"stone": "box_0", "T_map_stone": EXPECTED.tolist()}],
    }
    told = answer_of(Trial(bare(), reason="most_stones"))
    assert (told["detail"], told["refused_at_the_end"]) == ("", {})


def test_each_stone_is_told_with_its_errors(capsys: pytest.CaptureFixture[str]) -> None:
    place._tell(placed(0.0526, math.radians(12.34)))
    told = "    0  box_0  off its plan by 0.053 m, 12.3 deg; planned in 1.5 s of processor time"
    assert capsys.readouterr().err.rstrip() == told
    assert (place._short(0.12345), place._short(3), place._short("a")) == ("0.123", "3", "a")


# --- Pictures


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Figure, Path, int]]:
    """Keep the figures that are saved."""
    found: list[tuple[Figure, Path, int]] = []
    keep = lambda self, path, dpi: found.append((self, path, dpi))
    monkeypatch.setattr(Figure, "savefig", keep)
    return found


def two_boxes() -> AsBuilt:
    """Return a wall along y, on it a box in front of the other as seen from the side."""
    standing = (
        StandingStone(box("a", 0.4, 1.0, 0.5), pose(t=np.array([0.0, 0.0, 0.25]))),
        StandingStone(box("b", 0.4, 1.0, 0.3), pose(t=np.array([0.0, 0.2, 0.65]))),
    )
    start = bare()
    line = np.array([[0.0, -1.5], [0.0, 1.5]])
    return AsBuilt(replace(start.structure, line=line), start.ground, standing)


def outlines(axes: object) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the triangles of stones in the order of drawing, with their colours."""
    (found,) = [c for c in axes.collections if isinstance(c, PolyCollection)]
    shapes = [path.vertices[:3] for path in found.get_paths()]
    return list(zip(shapes, found.get_facecolors()[:, :3], strict=True))


def test_the_face_is_seen_along_the_wall_and_the_plan_from_above(drawn) -> None:
    pictures.draw(Path("wall.png"), two_boxes(), 1)
    ((figure, path, dpi),) = drawn
    assert (path, dpi, figure.get_size_inches().tolist()) == (Path("wall.png"), 80, [11.0, 6.5])
    side, above = figure.axes
    assert side.get_title(loc="left") == "wall: 2 stones, from the side"
    assert above.get_title(loc="left") == "from above"
    assert [a.get_xlabel() for a in (side, above)] == ["along [m]"] * 2
    assert (side.get_ylabel(), above.get_ylabel()) == ("height [m]", "across [m]")
    assert (side.get_aspect(), above.get_aspect()) == (1.0, 1.0)
    corners = np.concatenate([shape for shape, _ in outlines(side)])
    np.testing.assert_allclose(corners.min(axis=0), [-0.5, 0.0], atol=1e-9)
    np.testing.assert_allclose(corners.max(axis=0), [0.7, 0.8], atol=1e-9)
    corners = np.concatenate([shape for shape, _ in outlines(above)])
    np.testing.assert_allclose(corners.min(axis=0), [-0.5, -0.2], atol=1e-9)
    np.testing.assert_allclose(corners.max(axis=0), [0.7, 0.2], atol=1e-9)


def test_faces_towards_the_viewer_are_drawn_the_nearest_last_the_new_ones_coloured(drawn) -> None:
    lower = StandingStone(box("a", 1.0, 0.4, 0.5), pose(t=np.array([0.0, 0.1, 0.25])))
    upper = StandingStone(box("b", 1.0, 0.4, 0.3), pose(t=np.array([0.2, 0.0, 0.65])))
    pictures.draw(Path("wall.png"), bare().with_standing(upper, lower), 1)
    side, above = (outlines(axes) for axes in drawn[0][0].axes)
    assert (len(side), len(above)) == (4, 4)  # two triangles of each box; none edge-on
    # The upper box lies before the lower one, both as seen from the side and from above.
    assert [shape[:, 0].max() for shape, _ in side] == pytest.approx([0.5, 0.5, 0.7, 0.7])
    assert [shape[:, 0].max() for shape, _ in above] == pytest.approx([0.5, 0.5, 0.7, 0.7])
    assert [np.ptp(shape[:, 1]) for shape, _ in side] == pytest.approx([0.5, 0.5, 0.3, 0.3])
    old, new = np.array([0.62, 0.62, 0.60]), np.array([0.86, 0.58, 0.24])
    for shapes, light in ((side, 0.65), (above, 0.67)):  # from the left front, and from above
        for (_, colour), base in zip(shapes, (new, new, old, old), strict=True):
            np.testing.assert_allclose(colour, (0.45 + 0.55 * light) * base, atol=1e-6)


def test_the_envelope_is_drawn_over_the_ground(drawn) -> None:
    pictures.draw(Path("wall.png"), two_boxes(), 0)
    side, above = drawn[0][0].axes
    foot, top = side.lines
    assert [line.get_linestyle() for line in (foot, top)] == ["-", "--"]
    np.testing.assert_allclose(foot.get_xydata(), [[-1.5, 0.0], [1.5, 0.0]], atol=1e-9)
    np.testing.assert_allclose(top.get_xydata(), [[-1.5, 0.9], [1.5, 0.9]], atol=1e-9)
    (outline,) = [c for c in above.collections if not isinstance(c, PolyCollection)]
    border = np.concatenate([path.vertices for path in outline.get_paths()])
    np.testing.assert_allclose(border.min(axis=0), [-1.5, -0.4], atol=0.03)
    np.testing.assert_allclose(border.max(axis=0), [1.5, 0.4], atol=0.03)


def test_the_envelope_of_a_cairn_has_its_diameter(drawn) -> None:
    start = bare()
    cairn = AsBuilt(replace(start.structure, line=np.array([[1.0, 0.5]])), start.ground)
    pictures.draw(Path("cairn.png"), cairn, 0)
    foot, _ = drawn[0][0].axes[0].lines
    np.testing.assert_allclose(foot.get_xydata(), [[0.6, 0.0], [1.4, 0.0]], atol=1e-9)
    assert not [c for c in drawn[0][0].axes[0].collections if isinstance(c, PolyCollection)]


def test_courses_divide_the_stones_evenly(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[tuple[Path, AsBuilt, int]] = []
    monkeypatch.setattr(pictures, "draw", lambda *given: calls.append(given))
    stones = [placed(0.0, 0.0) for _ in range(6)]
    files = pictures.draw_courses(Path("out"), stones, 3)
    assert files == [Path("out") / f"course_{n}.png" for n in (1, 2, 3)]
    assert [(path, first) for path, _, first in calls] == list(zip(files, (0, 2, 4), strict=True))
    assert [built for _, built, _ in calls] == [stones[n].built for n in (1, 3, 5)]
    assert len(pictures.draw_courses(Path("out"), stones[:2], 4)) == 2


# --- Stones


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    stone = box("one", 0.8, 0.6, 0.4)
    lines = [f"v {x} {y} {z}" for x, y, z in stone.vertices]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in stone.triangles]
    for name in ("b.obj", "a.OBJ", "c.obj"):
        (tmp_path / name).write_text("\n".join(lines) + "\n", encoding="utf-8")
    (tmp_path / "open.obj").write_text("\n".join(lines[:-1]) + "\n", encoding="utf-8")
    (tmp_path / "notes.txt").write_text("mine")
    return tmp_path


def test_the_meshes_of_a_folder_are_read_in_order_and_scaled(folder: Path) -> None:
    choice = StoneChoice(scale=0.5, density=2000.0)
    stones, told = read_stones(folder, choice, np.random.default_rng(0))
    assert [stone.name for stone in stones] == ["a.OBJ", "b.obj", "c.obj"]
    assert np.ptp(stones[0].vertices, axis=0) == pytest.approx([0.4, 0.3, 0.2])
    assert stones[0].mass_kg == pytest.approx(0.4 * 0.3 * 0.2 * 2000.0)
    assert list(told) == ["open.obj"]
    assert re.match("left out: .*not closed", told["open.obj"])


def test_an_open_mesh_can_be_replaced_by_its_hull(folder: Path) -> None:
    stones, told = read_stones(folder, StoneChoice(repair="hull"), np.random.default_rng(0))
    assert told == {"open.obj": "its mesh is not closed: its convex hull is used"}
    assert stones[-1].name == "open.obj"
    assert stones[-1].mass_kg == pytest.approx(0.8 * 0.6 * 0.4 * 2600.0)


def test_so_many_stones_are_drawn_by_the_seed(folder: Path) -> None:
    (folder / "open.obj").unlink()
    drawn = {
        tuple(s.name for s in read_stones(folder, StoneChoice(count=2), rng)[0])
        for rng in map(np.random.default_rng, range(12))
    }
    assert {len(set(names)) for names in drawn} == {2}
    assert len(drawn) > 3


def test_a_folder_that_is_none_is_refused(folder: Path) -> None:
    with pytest.raises(ConfigError, match=r"none: no such folder; give one of OBJ, PLY or STL"):
        read_stones(folder / "none", StoneChoice(), np.random.default_rng(0))
