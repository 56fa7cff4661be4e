"""The state of plugins is kept as the mission goes on, and given back when it is resumed."""

import pytest

from executive import registry
from executive.interfaces.plugin import Plugin
from executive.mission.record.keeper import Instant, Keeper


class Robot(Plugin):
    capability = "robot"

    def __init__(self):
        self.state = {"joint": 0.0}

    def keep(self):
        return self.state

    def restore(self, kept):
        self.state = kept


class Map(Plugin):
    capability = "mapping"

    def __init__(self):
        self.points, self.revision, self.asked = 0, 0, 0

    def keep(self):
        self.asked += 1
        return {"points": self.points}

    def restore(self, kept):
        self.points = kept["points"]

    def grow(self, points):
        self.points, self.revision = points, self.revision + 1


class Forgetful(Plugin):
    """Learns from measurements, and keeps nothing."""

    capability = "estimation"


class Stateless(Plugin):
    capability = "motion"
    is_stateless = True


@pytest.fixture(autouse=True)
def names(monkeypatch):
    monkeypatch.setattr(registry, "name_of", lambda capability, kind: kind.__name__.lower())


@pytest.fixture
def plugins():
    kinds = {"robot": Robot, "mapping": Map, "estimation": Forgetful, "motion": Stateless}
    return {capability: kind() for capability, kind in kinds.items()}


def at(time_s, tick=7):
    return Instant(tick, time_s, time_s)


def kept_points(folder):
    """Return what a new mission in the same folder takes back of the map."""
    plugins = {"robot": Robot(), "mapping": Map()}
    keeper = Keeper(folder, plugins)
    keeper.restore()
    return plugins["mapping"].points


def test_what_was_kept_is_given_back_with_its_time(tmp_path, plugins):
    keeper = Keeper(tmp_path / "kept", plugins)
    plugins["robot"].state = {"joint": 0.5}
    plugins["mapping"].grow(9)
    keeper.keep(Instant(7, 3.5, 4.5), leaf_ended=True)
    keeper.close()
    again = {"robot": Robot(), "mapping": Map(), "estimation": Forgetful(), "motion": Stateless()}
    instant, restored, lost = Keeper(tmp_path / "kept", again).restore()
    assert (instant.tick, instant.mission_s, instant.machine_s) == (7, 3.5, 4.5)
    assert (restored, lost) == (("robot", "mapping"), ("estimation",))
    assert again["robot"].state == {"joint": 0.5}
    assert again["mapping"].points == 9


def test_where_nothing_was_kept_all_that_has_a_state_is_lost(tmp_path, plugins):
    instant, restored, lost = Keeper(tmp_path / "kept", plugins).restore()
    assert (instant, restored) == (None, ())
    assert lost == ("robot", "estimation", "mapping")


def test_a_robot_that_lives_elsewhere_has_its_time_kept_alone(tmp_path, plugins):
    plugins["robot"].state = {}
    keeper = Keeper(tmp_path / "kept", plugins)
    keeper.keep(at(2.0), leaf_ended=False)
    keeper.close()
    again = Robot()
    instant, restored, _ = Keeper(tmp_path / "kept", plugins | {"robot": again}).restore()
    assert instant.machine_s == 2.0
    assert "robot" not in restored
    assert again.state == {"joint": 0.0}


def test_a_damaged_state_is_lost_and_the_others_are_given_back(tmp_path, plugins):
    keeper = Keeper(tmp_path / "kept", plugins)
    plugins["mapping"].grow(9)
    keeper.keep(at(1.0), leaf_ended=True)
    keeper.close()
    (tmp_path / "kept" / "mapping-map").write_bytes(b"no value")
    _, restored, lost = Keeper(tmp_path / "kept", plugins).restore()
    assert (restored, lost) == (("robot",), ("estimation", "mapping"))


def test_a_map_is_written_when_a_leaf_has_ended_and_every_five_seconds(tmp_path, plugins):
    keeper, mapping = Keeper(tmp_path / "kept", plugins), plugins["mapping"]
    mapping.grow(1)
    keeper.keep(at(4.75), leaf_ended=False)
    assert kept_points(tmp_path / "kept") == 0
    keeper.keep(at(5.0), leaf_ended=False)
    assert kept_points(tmp_path / "kept") == 1
    mapping.grow(2)
    keeper.keep(at(9.75), leaf_ended=False)  # five seconds after it was written, not counted from 0
    assert kept_points(tmp_path / "kept") == 1
    keeper.keep(at(9.875), leaf_ended=True)
    assert kept_points(tmp_path / "kept") == 2
    mapping.grow(3)
    keeper.keep(at(14.75), leaf_ended=False)
    assert kept_points(tmp_path / "kept") == 2
    keeper.keep(at(15.0), leaf_ended=False)
    assert kept_points(tmp_path / "kept") == 3


def test_a_map_that_has_not_changed_is_not_asked_for(tmp_path, plugins):
    keeper, mapping = Keeper(tmp_path / "kept", plugins), plugins["mapping"]
    keeper.keep(at(1.0), leaf_ended=True)
    assert mapping.asked == 0
    mapping.grow(1)
    keeper.keep(at(2.0), leaf_ended=True)
    keeper.keep(at(3.0), leaf_ended=True)
    assert mapping.asked == 1


def test_the_robot_is_written_at_each_tick(tmp_path, plugins):
    keeper = Keeper(tmp_path / "kept", plugins)
    for tick in range(3):
        plugins["robot"].state = {"joint": float(tick)}
        keeper.keep(at(0.05 * tick, tick), leaf_ended=False)
    keeper.close()
    again = Robot()
    instant, *_ = Keeper(tmp_path / "kept", {"robot": again}).restore()
    assert (instant.tick, again.state) == (2, {"joint": 2.0})


def test_a_folder_that_cannot_be_written_is_told_once_and_nothing_follows(tmp_path, plugins):
    (tmp_path / "kept").write_text("a file where the folder should be")
    keeper = Keeper(tmp_path / "kept", plugins)
    assert keeper.failure is None
    keeper.keep(at(1.0), leaf_ended=True)
    failure = keeper.failure
    assert isinstance(failure, OSError)
    (tmp_path / "kept").unlink()
    keeper.keep(at(2.0), leaf_ended=True)
    assert keeper.failure is failure
    assert not (tmp_path / "kept").exists()
    keeper.close()
