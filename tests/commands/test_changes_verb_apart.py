"""The verb `changes` apart: what differs, what has moved, and what is written."""

import json
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from executive.clouds.changes import Standing
from executive.commands.clouds import changes as changes_verb
from executive.messages.cloud import Cloud
from tests.commands.segmented import segment


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
    monkeypatch.setattr("executive.clouds.reader.read_site", lambda path, _: clouds[path])
    monkeypatch.setattr("executive.clouds.coordinate_system.coordinate_system", lambda path: "EPSG")
    guess = np.eye(4)
    guess[0, 3] = 10.0
    monkeypatch.setattr("executive.commands.clouds.guess.read_guess", lambda given: (guess, 3.0))
    written: list[Any] = []
    monkeypatch.setattr(
        "executive.clouds.ply_writer.write_parts", lambda *given: written.append(given)
    )
    out = tmp_path / "c.ply"
    changes_verb.changes(Path("a.ply"), Path("b.ply"), None, 0.05, 900.0, ["a=b"], out, True)
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
