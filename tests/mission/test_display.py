"""What a mission hands to its viewer, and that an error of the viewer ends the showing alone."""

from types import SimpleNamespace

import pytest

from executive.mission import display as module
from executive.mission.display import Display

CLOCK = SimpleNamespace(now_s=lambda: 7.5)


class Viewer:
    def __init__(self, *, fails_at: str = "") -> None:
        self.shown, self._fails_at = [], fails_at

    def show(self, time_s: float, entity: str, value: object) -> None:
        if entity == self._fails_at:
            raise OSError("the window is closed")
        self.shown.append((time_s, entity, value))


@pytest.fixture(autouse=True)
def tree(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [SimpleNamespace(path="main", status="RUNNING")]
    monkeypatch.setattr(module, "node_states", lambda root: rows)


def test_the_machine_is_shown_with_its_tree_at_the_missions_time() -> None:
    viewer = Viewer()
    display = Display(viewer, CLOCK, pytest.fail)
    assert display.is_on
    display.show_machine(None, "a state", None)
    display.show_machine(None, "a state", "joints")
    once = [(7.5, "tree", {"main": "RUNNING"}), (7.5, "state", "a state")]
    assert viewer.shown == [*once, *once, (7.5, "joints", "joints")]


def test_after_an_error_of_the_viewer_nothing_more_is_shown() -> None:
    viewer, errors = Viewer(fails_at="map"), []
    display = Display(viewer, CLOCK, lambda *told: errors.append(told))
    for entity in ("path", "map", "path"):
        display.show(entity, 1)
    assert viewer.shown == [(7.5, "path", 1)]
    assert [(one is viewer, str(error)) for one, error in errors] == [
        (True, "the window is closed")
    ]
    assert not display.is_on


def test_without_a_viewer_nothing_is_shown() -> None:
    display = Display(None, CLOCK, pytest.fail)
    display.show("map", 1)
    assert not display.is_on
