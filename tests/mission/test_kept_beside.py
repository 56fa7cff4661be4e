"""The state of plugins is written as the mission goes, on the wall clock beside the tick."""

import threading

import pytest

from executive.interfaces.plugin import Plugin
from executive.mission.record.keeper import Instant, Keeper

NOW = Instant(1, 0.05, 0.05)


class Robot(Plugin):
    """Keeps nothing: it lives elsewhere."""


class Store(Plugin):
    """Keeps a number; a test may hold up who asks for it."""

    capability = "objects"

    def __init__(self):
        self.revision, self.restored = 1, None
        self.go_on = threading.Event()
        self.asked = threading.Event()

    def keep(self):
        revision = self.revision
        self.asked.set()
        assert self.go_on.wait(60.0)
        return {"number": revision}

    def restore(self, kept):
        self.restored = kept["number"]


class Readable(Store):
    beside_tick = ("keep",)


def keeper_of(tmp_path, store, **options):
    return Keeper(tmp_path / "kept", {"robot": Robot(), "objects": store}, **options)


def restored(tmp_path, kind=Readable):
    again = kind()
    keeper_of(tmp_path, again).restore()
    return again.restored


def test_in_lock_step_the_state_is_written_within_the_tick(tmp_path):
    store = Store()
    store.go_on.set()
    keeper = keeper_of(tmp_path, store)
    keeper.keep(NOW, leaf_ended=True)
    assert restored(tmp_path, Store) == 1
    keeper.close()


def test_on_the_wall_clock_the_tick_waits_for_no_plugin_that_a_thread_may_ask(tmp_path):
    store = Readable()
    keeper = keeper_of(tmp_path, store, beside=True)
    keeper.keep(NOW, leaf_ended=True)  # would wait for ever
    assert store.asked.wait(60.0)
    store.go_on.set()
    keeper.settle()
    assert restored(tmp_path) == 1
    keeper.close()


def test_what_changes_while_it_is_written_is_written_again(tmp_path):
    store = Readable()
    keeper = keeper_of(tmp_path, store, beside=True)
    keeper.keep(NOW, leaf_ended=True)
    assert store.asked.wait(60.0)
    store.revision = 2
    keeper.keep(NOW, leaf_ended=True)  # still being written
    store.go_on.set()
    while restored(tmp_path) != 2:  # the loop ticks on; no leaf ends any more
        keeper.keep(NOW, leaf_ended=False)
    keeper.settle()
    keeper.close()


def test_a_folder_that_cannot_be_written_is_told(tmp_path):
    store = Store()
    store.go_on.set()
    keeper = keeper_of(tmp_path, store, beside=True)
    keeper.keep(NOW, leaf_ended=False)
    (name,) = keeper._written
    (tmp_path / "kept" / f"{name}.partial").mkdir()
    keeper.keep(NOW, leaf_ended=True)
    keeper.settle()
    assert isinstance(keeper.failure, OSError)
    keeper.close()


def test_an_error_of_a_plugin_that_a_thread_asks_is_raised(tmp_path):
    class Broken(Readable):
        def keep(self):
            raise ValueError("no state")

    keeper = keeper_of(tmp_path, Broken(), beside=True)
    keeper.keep(NOW, leaf_ended=True)
    with pytest.raises(ValueError, match="no state"):
        keeper.settle()
    keeper.close()
