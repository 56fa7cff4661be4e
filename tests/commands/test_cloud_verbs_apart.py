"""`align`, `survey` and `--view` apart from their plugins: what they hand on, write and tell."""

import json
import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from executive.clouds.coordinate_system import coordinate_system
from executive.clouds.ply_writer import write_parts
from executive.clouds.reader import read_points
from executive.commands.clouds import view
from executive.commands.clouds.alignment_answer import alignment_answer, alignment_view, verdict
from executive.config import Settings
from executive.errors import ConfigError
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.messages.alignment import Alignment, Rival, Uncertainty
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment, Segmentation
from tests.commands.in_process import executive

RNG = np.random.default_rng(5)
SITE = RNG.uniform([-4, -4, 0], [4, 4, 1], (400, 3))
T_FOUND = pose(from_rpy(0.0, 0.0, 0.5), np.array([1.0, 2.0, 0.3]))


class PhotographSettings(Settings):
    """As a plugin that takes photographs has them."""

    photographs: str
    positions: str = ""
    motion: dict[str, float] = {}
    work: str = ""


class Plugin:
    """Answers with what a test gives, and keeps what it is asked."""

    def __init__(self, answer: Any, account: Mapping[str, Any] | None = None) -> None:
        self.answer, self.kept_account = answer, account or {}
        self.asked: list[tuple[Any, ...]] = []
        self.choices: Any = None
        self.known: dict[str, Any] = {}

    def align(self, *given: Any) -> Alignment:
        self.asked.append(given)
        return self.answer

    def register(self, *given: Any) -> Alignment:
        return self.align(*given)

    def follow(self, tell: Any) -> None:
        tell("half of it is done")

    def survey(self, rng: np.random.Generator) -> Cloud:
        self.asked.append((rng.bit_generator.state["state"],))
        return self.answer

    def account(self) -> Mapping[str, Any]:
        return self.kept_account


@pytest.fixture
def stand(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Put a plugin in the place of the one that is chosen."""

    def put(plugin: Any) -> Any:
        @contextmanager
        def chosen(interface: type, choices: Any, known: Any = None) -> Iterator[Any]:
            plugin.choices = choices
            if known is not None:
                plugin.known = dict(known["surveying"](PhotographSettings))
            yield plugin

        monkeypatch.setattr("executive.commands.chosen.chosen", chosen)
        return plugin

    return put


@pytest.fixture
def clouds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_parts(Path("moved.ply"), [SITE])
    write_parts(Path("fixed.ply"), [SITE + [0.5, 0, 0]], "EPSG:2056")
    return tmp_path


def found(accepted: bool = True, **change: Any) -> Alignment:
    return Alignment(T_FOUND, accepted, "1.2 cm over 80 %", 0.012, 0.8, **change)


# --- align


def test_align_hands_the_scaled_source_and_the_guess_on_and_writes_both(
    clouds: Path,
    stand: Any,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    plugin = stand(Plugin(found()))
    Path("guess.json").write_text(json.dumps({"T": T_FOUND.tolist(), "scale": 2.0}))
    words = ("--guess", "guess.json", "--reach", 0.4, "--out", "both.ply", "--json")
    assert executive(monkeypatch, "align", "moved.ply", "fixed.ply", *words) == 0
    ((target, source, T_guess, reach_m),) = plugin.asked
    assert (target.frame, source.frame, reach_m) == ("target", "source", 0.4)
    np.testing.assert_allclose(source.points, 2.0 * SITE, atol=1e-5)
    np.testing.assert_allclose(target.points, SITE + [0.5, 0, 0], atol=1e-5)
    np.testing.assert_allclose(T_guess, T_FOUND)
    said = capsys.readouterr()
    told = json.loads(said.out)
    assert "accepted: 1.2 cm over 80 %" in said.err
    assert (told["accepted"], told["scale"], told["crs"]) == (True, 2.0, "EPSG:2056")
    assert (told["rmse_m"], told["overlap"]) == (0.012, 0.8)
    np.testing.assert_allclose(told["T"], T_FOUND)
    both = read_points(Path("both.ply"))
    assert len(both) == 2 * len(SITE)
    np.testing.assert_allclose(both[len(SITE) :], found(scale=2.0).apply(SITE), atol=1e-3)
    assert coordinate_system(Path("both.ply")) == "EPSG:2056"


def test_align_writes_nothing_if_the_motion_is_refused(
    clouds: Path, stand: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    stand(Plugin(found(accepted=False)))
    assert executive(monkeypatch, "align", "moved.ply", "fixed.ply", "--out", "both.ply") == 1
    said = capsys.readouterr()
    assert "refused: 1.2 cm over 80 %" in said.err
    assert said.out == ""
    assert not Path("both.ply").exists()


@pytest.mark.parametrize("verb", ["align", "register"])
def test_a_crop_of_each_cloud_is_all_that_is_looked_at_and_written(
    verb: str, clouds: Path, stand: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    plugin = stand(Plugin(found()))
    words = ("--crop", "-1,-2,3,2", "--crop-source", "1,1,2.5", "--out", "both.ply")
    assert executive(monkeypatch, verb, "moved.ply", "fixed.ply", *words) == 0
    target, source = plugin.asked[0][:2]
    box = SITE + [0.5, 0, 0]
    box = box[(np.abs(box[:, 0] - 1) <= 2) & (np.abs(box[:, 1]) <= 2)]
    circle = SITE[np.hypot(SITE[:, 0] - 1, SITE[:, 1] - 1) < 2.5]
    np.testing.assert_array_equal(target.points, box)
    np.testing.assert_array_equal(source.points, circle)
    assert len(read_points(Path("both.ply"))) == len(box) + len(circle) < len(SITE)


@pytest.mark.parametrize("verb", ["align", "register"])
@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--crop", "1,2"), "--crop: '1,2' is not x,y,radius or x_low"),
        (("--crop-source", "3,3,1,1"), "--crop-source: '3,3,1,1' is not x,y,radius or x_low"),
        (("--crop", "90,0,5"), "--crop: no point is in 90,0,5; the cloud has x from -3."),
        (("--crop-source", "0,9,1"), "--crop-source: no point is in 0,9,1; the cloud has x from"),
    ],
)
def test_a_crop_without_an_area_or_a_point_is_refused(
    verb: str, clouds: Path, stand: Any, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str], words: tuple[str, str], told: str,
) -> None:  # fmt: skip
    plugin = stand(Plugin(found()))
    assert executive(monkeypatch, verb, "moved.ply", "fixed.ply", *words) == 2
    assert told in capsys.readouterr().err
    assert plugin.asked == []


@pytest.mark.parametrize("verb", ["align", "register"])
def test_each_cloud_of_a_folder_is_laid_over_the_target_once(
    verb: str, clouds: Path, stand: Any, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    Path("scans").mkdir()
    for name in ("a.ply", "b.ply"):
        write_parts(Path("scans") / name, [SITE])
    Path("scans/c.ply").write_bytes(b"ply")
    words = (verb, "scans", "fixed.ply", "--crop-source", "0,0,3")
    plugin = stand(Plugin(found()))
    assert executive(monkeypatch, *words, "--out", "answers") == 1
    said = capsys.readouterr().err
    assert "a.ply: accepted: 1.2 cm over 80 %" in said
    assert "c.ply: cannot be used: " in said
    assert "scans: 2 of 3 clouds" in said
    first = json.loads(Path("answers/a.ply.json").read_text())
    assert (first["accepted"], first["crs"]) == (True, "EPSG:2056")
    assert first["asked"]["target"] == str(Path("fixed.ply").resolve())
    assert first["asked"]["crop_source"] == "0,0,3"
    inside = int((np.hypot(*SITE[:, :2].T) < 3).sum())
    assert len(read_points(Path("answers/b.ply.both.ply"))) == len(SITE) + inside
    write_parts(Path("scans/c.ply"), [SITE])
    assert executive(monkeypatch, *words, "--out", "answers") == 0
    assert len(plugin.asked) == 3
    assert "b.ply: done before (2 of 3)" in capsys.readouterr().err
    plugin.answer = found(accepted=False)  # of what is asked anew
    assert executive(monkeypatch, *words, "--out", "answers", "--crop", "0,0,9") == 1
    assert len(plugin.asked) == 6
    assert "scans: 3 of 3 clouds, 3 refused" in capsys.readouterr().err
    assert not list(Path("answers").glob("*.both.ply"))


@pytest.mark.parametrize("verb", ["align", "register"])
@pytest.mark.parametrize(
    ("words", "told"),
    [
        ((), "--out: scans is a folder of clouds: name another folder for answers"),
        (("--out", "scans"), "name another folder for answers"),
        (("--out", "answers", "--json"), "--json: the answers of a folder are files in"),
        (("--out", "answers", "--view"), "--view: shows one cloud; name a file of the folder"),
        (("--out", "answers"), "scans: holds no cloud (.ply"),
    ],
)
def test_a_folder_is_refused_what_one_cloud_has(
    verb: str, clouds: Path, stand: Any, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str], words: tuple[str, ...], told: str,
) -> None:  # fmt: skip
    Path("scans").mkdir()
    stand(Plugin(found()))
    assert executive(monkeypatch, verb, "scans", "fixed.ply", *words) == 2
    assert told in capsys.readouterr().err
    assert not Path("answers").exists()


def test_another_guess_or_reach_is_another_answer_of_align(
    clouds: Path, stand: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    Path("scans").mkdir()
    write_parts(Path("scans/a.ply"), [SITE])
    plugin = stand(Plugin(found()))
    words = ("align", "scans", "fixed.ply", "--out", "answers", "--guess", "guess.txt")
    for number, (x, reach) in enumerate([(1.5, 0.3), (2.5, 0.3), (2.5, 0.4)], 1):
        Path("guess.txt").write_text(f"1 0 0 {x}\n0 1 0 0.1\n0 0 1 0\n0 0 0 1\n")
        for _ in range(2):
            assert executive(monkeypatch, *words, "--reach", reach) == 0
            assert len(plugin.asked) == number


@pytest.mark.parametrize("verb", ["align", "register"])
def test_a_file_that_cannot_be_written_is_refused_before_a_cloud_is_read(
    verb: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert executive(monkeypatch, verb, "none.ply", "none.ply", "--out", "both.txt") == 2
    assert (
        "--out: both.txt: name a .ply or .pcd or .las or .laz or .e57 file"
        in capsys.readouterr().err
    )


def test_an_answer_holds_the_rival_and_the_doubt() -> None:
    plain = alignment_answer(found(matched_segments=((0, 3),), timings_ms={"total": 2.0}))
    assert plain["rival"] is None
    assert plain["uncertainty"] is None
    assert plain["matched_segments"] == [[0, 3]]
    assert plain["timings_ms"] == {"total": 2.0}
    assert (plain["reason"], plain["is_final"]) == ("1.2 cm over 80 %", False)
    rival = Rival(np.eye(4), 1.1, 0.2, ((1, 2),))
    doubt = Uncertainty(0.1 * np.eye(6), np.array([1.0, 2.0, 3.0]))
    full = alignment_answer(found(rival=rival, uncertainty=doubt, is_final=True))
    assert full["rival"] == {
        "T": np.eye(4).tolist(),
        "scale": 1.1,
        "likelihood_ratio": 0.2,
        "matched_segments": [[1, 2]],
    }
    assert full["uncertainty"] == {"covariance": (0.1 * np.eye(6)).tolist(), "centre": [1, 2, 3]}
    assert full["is_final"] is True


def test_a_refusal_names_a_unit_that_would_explain_it() -> None:
    assert verdict(found(), SITE, SITE) == "accepted: 1.2 cm over 80 %"
    refused = found(accepted=False)
    assert verdict(refused, SITE, SITE) == "refused: 1.2 cm over 80 %"
    told = verdict(refused, SITE / 0.3048, SITE)
    assert told.startswith("refused: 1.2 cm over 80 %; ")
    assert "feet" in told


def test_a_view_of_an_alignment_lies_about_the_middle_of_a_national_grid(
    capsys: pytest.CaptureFixture[str],
) -> None:
    far = np.array([2_600_000.0, 1_200_000.0, 440.0])
    shown = alignment_view(found(), SITE, SITE + far)
    assert list(shown) == ["alignment", "target", "drone"]
    middle = np.round((SITE.min(axis=0) + SITE.max(axis=0)) / 2 + far)
    assert shown["target"].frame == shown["drone"].frame == "map"
    np.testing.assert_allclose(shown["target"].points, SITE + far - middle, atol=1e-6)
    np.testing.assert_allclose(shown["drone"].points, found().apply(SITE) - middle, atol=1e-6)
    said = capsys.readouterr().err
    assert said == f"shown about {middle[0]:.0f} {middle[1]:.0f} {middle[2]:.0f} m\n"
    assert list(alignment_view(found(accepted=False), SITE, SITE)) == ["alignment", "target"]
    assert not view.near_origin(SITE + [990.0, 0, 0]).any()
    assert view.near_origin(SITE - [1010.0, 0, 0])[0] == np.round(
        (SITE[:, 0].min() + SITE[:, 0].max()) / 2 - 1010.0
    )


# --- view


class Viewer:
    def __init__(self, refusal: str = "") -> None:
        self.refusal = refusal
        self.opened: list[str] = []
        self.shown: list[tuple[float, str, Any]] = []

    def open(self, path: str) -> None:
        self.opened.append(path)

    def show_live(self, port: int) -> str:
        if self.refusal:
            raise ConfigError(self.refusal)
        return f"a window at {port}"

    def show(self, at_s: float, name: str, value: Any) -> None:
        self.shown.append((at_s, name, value))


@pytest.mark.parametrize(
    ("environment", "refusal", "told"),
    [
        ({"DISPLAY": ":0"}, "", "view: a window at 9876"),
        ({"WAYLAND_DISPLAY": "w"}, "no such program", "view: no viewer: no such program"),
        ({"DISPLAY": "", "OTHER": "1"}, "", "view: there is no display, so no viewer was started"),
    ],
)
def test_a_view_is_written_and_shown_where_there_is_a_display(
    stand: Any,
    capsys: pytest.CaptureFixture[str],
    environment: dict[str, str],
    refusal: str,
    told: str,
) -> None:
    viewer = stand(Viewer(refusal))
    view.show(Path("a.rrd"), {"one": 1, "two": 2}, environment)
    assert viewer.opened == ["a.rrd"]
    assert viewer.shown == [(0.0, "one", 1), (0.0, "two", 2)]
    first = "view: a.rrd; `rerun --bind 127.0.0.1 a.rrd` shows it"
    assert capsys.readouterr().err.splitlines() == [first, told]


def test_a_recording_lies_beside_the_output_or_here() -> None:
    assert view.recording_of(Path("a/site.ply"), None) == Path("site.rrd")
    assert view.recording_of(Path("a/site.ply"), Path("b/out.json")) == Path("b/out.rrd")


def test_a_segmentation_is_shown_about_another_origin() -> None:
    points = np.array([[1.0, 2.0, 3.0], [2.0, 2.0, 3.0]])
    one = Segment(0, points, points.mean(axis=0), np.array([1.0, 0.5, 0.2]))
    whole = Segmentation("site", (one,), Cloud("site", points), np.array([0.0, 0, 1, 0]))
    moved = view.shifted(whole, np.array([1.0, 1.0, 1.0]))
    assert (moved.frame, moved.ground.frame) == ("map", "map")
    assert moved.ground.points.tolist() == (points - 1).tolist()
    assert moved.segments[0].points.tolist() == (points - 1).tolist()
    assert moved.segments[0].centroid.tolist() == [0.5, 1.0, 2.0]
    assert moved.segments[0].extents.tolist() == [1.0, 0.5, 0.2]


# --- survey


def test_survey_writes_a_cloud_in_the_coordinates_of_the_positions(
    tmp_path: Path,
    stand: Any,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    origin = {"origin_x_m": 2000.0, "origin_y_m": 1000.0, "origin_z_m": 400.0}
    plugin = stand(Plugin(Cloud("map", SITE), {**origin, "pictures": 40, "left": ("a", "b")}))
    out = tmp_path / "survey.ply"
    words = ("photos", "--out", out, "--crs", "EPSG:2056", "--positions", "p.csv")
    more = ("--view-angle", 60, "--json", "--seed", 3, "--set", "surveying.voxel_m=0.03")
    assert executive(monkeypatch, "survey", *words, *more) == 0
    assert plugin.known == {
        "photographs": "photos",
        "positions": "p.csv",
        "motion": {"view_angle_rad": pytest.approx(math.radians(60))},
        "work": str(tmp_path / "survey.work"),
    }
    assert plugin.asked == [(np.random.default_rng(3).bit_generator.state["state"],)]
    np.testing.assert_allclose(read_points(out), SITE + list(origin.values()), atol=1e-3)
    assert coordinate_system(out) == "EPSG:2056"
    said = capsys.readouterr()
    told = json.loads(said.out)
    assert (told["points"], told["crs"], told["pictures"]) == (400, "EPSG:2056", 40)
    lines = said.err.splitlines()
    assert lines[0] == "  half of it is done"
    assert "  pictures         40" in lines
    assert "  left             a, b" in lines
    assert lines[-1] == f"photos: 400 points, {out}"


def test_survey_without_options_gives_the_folder_alone_and_no_coordinates(
    tmp_path: Path, stand: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    plugin = stand(Plugin(Cloud("map", SITE)))
    out = tmp_path / "survey.ply"
    assert executive(monkeypatch, "survey", "photos", "--out", out) == 0
    assert plugin.known == {"photographs": "photos", "work": str(tmp_path / "survey.work")}
    np.testing.assert_allclose(read_points(out), SITE, atol=1e-5)
    assert coordinate_system(out) == ""
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--out", "survey.txt"], "--out: survey.txt: name a .ply or"),
        (["--view-angle", "6"], "--view-angle: 6 is not within 6 to 160 degrees"),
        (["--view-angle", "160"], "--view-angle: 160 is not within 6 to 160 degrees"),
        (["--crs", "EPSG:2056"], "--crs: the positions are not in x,y,z, and nothing is proj"),
    ],
)
def test_survey_refuses_before_it_computes(
    tmp_path: Path,
    stand: Any,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: list[str],
    told: str,
) -> None:
    plugin = stand(Plugin(Cloud("map", SITE)))
    out = [] if "--out" in words else ["--out", tmp_path / "survey.ply"]
    assert executive(monkeypatch, "survey", "photos", *out, *words) == 2
    assert told in capsys.readouterr().err
    assert plugin.asked == []
