"""The state of a simulated machine's world is kept, and goes on; a damaged one is refused."""

import pytest

from executive.errors import DataError
from executive.interfaces.oracle import Witness
from executive.journal.newest_file import NewestFile
from executive.mission.machine_folder import MachineFolder, WorldKeeper


class World:
    """A robot of which only its state is asked."""

    def __init__(self, kept=None):
        self.kept = kept

    def keep(self):
        return self.kept

    def restore(self, kept):
        self.kept = kept


@pytest.fixture
def folder(tmp_path):
    return MachineFolder(tmp_path)


def test_a_world_goes_on_where_it_was_kept_last(folder):
    keeper = WorldKeeper(folder, World({"stone": 1}))
    keeper.keep(2.0)
    keeper.end(2.5)
    again = World()
    assert WorldKeeper(folder, again).restore() == 2.5
    assert again.kept == {"stone": 1}


def test_without_a_state_it_begins_anew(folder):
    world = World("as it was made")
    assert WorldKeeper(folder, world).restore() == 0.0
    assert world.kept == "as it was made"


def test_a_state_that_cannot_be_read_is_refused_with_the_cure(folder):
    folder.state.parent.mkdir()
    damaged = NewestFile(folder.state)
    damaged.write(b"no value")
    damaged.close()
    with pytest.raises(DataError, match=r"cannot be read .* start the mission anew"):
        WorldKeeper(folder, World()).restore()


class Knowing(World, Witness):
    """A robot that knows what really happened."""

    def write_truth(self, path):
        path.write_text("truth")

    def read_truth(self, path, zero_s):
        raise NotImplementedError


def test_the_truth_is_left_at_the_end_by_a_machine_that_knows_it(folder):
    keeper = WorldKeeper(folder, Knowing({}))
    keeper.keep(1.0)
    assert not folder.truth.exists()
    keeper.end(2.0)
    assert folder.truth.read_text() == "truth"
    assert WorldKeeper(folder, World()).restore() == 2.0


def test_a_machine_that_does_not_know_the_truth_leaves_none(folder):
    WorldKeeper(folder, World({})).end(2.0)
    assert not folder.truth.exists()


def test_of_many_states_the_newest_is_kept(folder):
    world = World()
    keeper = WorldKeeper(folder, world)
    for second in range(1, 6):
        world.kept = {"stone": second}
        keeper.keep(float(second))
    assert WorldKeeper(folder, again := World()).restore() == 5.0  # it was not ended, but killed
    assert again.kept == {"stone": 5}
    keeper.end(6.0)


def test_the_machines_last_line_is_what_it_says_at_its_end(folder):
    folder.log.write_bytes(b"listens\nno such site: \xff\n\n")
    assert folder.last_words() == "no such site: \N{REPLACEMENT CHARACTER}"
    folder.log.write_text("\n")
    assert "without a word" in folder.last_words()
