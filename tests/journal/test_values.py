"""Values of ports are kept bit for bit, and nothing is run when they are read."""

from dataclasses import dataclass

import numpy as np
import pytest

from executive.errors import DataError
from executive.events.event import plain
from executive.journal.value_file import from_bytes, to_bytes
from executive.journal.value_folder import ValueFolder
from executive.messages.cloud import Cloud
from executive.messages.hold import Hold
from executive.messages.stone import StoneState
from executive.messages.trajectory import JointTrajectory


@pytest.mark.parametrize(
    "value",
    [
        None,
        True,
        3,
        0.1 + 0.2,
        float("inf"),
        "stone",
        [1, [2.5, "a"]],
        (1, (2, 3)),
        {1: np.eye(2), "a": (np.float32(0.1), None)},
        {3, 1, 2},
        StoneState.HELD,
        Hold(3, np.eye(4), 0.4),
        Cloud("map", np.random.default_rng(0).normal(size=(100, 3))),
        {"state": 2**100, "array": np.array([1, 2], np.uint64)},
        np.zeros((0, 3)),
    ],
    ids=str,
)
def test_a_value_comes_back_as_it_was(value):
    again = from_bytes(to_bytes(value))
    assert type(again) is type(value)
    assert plain(again) == plain(value)
    assert to_bytes(again) == to_bytes(value)


def test_a_trajectory_comes_back_with_its_motion():
    times = np.linspace(0, 1, 5)
    path = JointTrajectory(("a", "b"), times, np.outer(times, [1, 2]), np.ones((5, 1)) * [1, 2])
    again = from_bytes(to_bytes(path))
    assert (again.at(0.3)[0] == path.at(0.3)[0]).all()


def test_large_values_are_kept_in_files_and_damage_shows(tmp_path):
    folder = ValueFolder(tmp_path / "values")
    small, large = folder.put((1, 2)), folder.put(np.arange(1000.0))
    assert (folder.get(small), folder.get(large)[-1]) == ((1, 2), 999.0)
    (file,) = (tmp_path / "values").iterdir()
    assert folder.put(np.arange(1000.0)) == large  # once
    file.write_bytes(file.read_bytes()[:-1] + b"x")
    with pytest.raises(DataError, match="was changed"):
        folder.get(large)
    file.unlink()
    with pytest.raises(DataError, match="cannot be read"):
        folder.get(large)


def test_what_cannot_be_kept_is_named(tmp_path):
    folder = ValueFolder(tmp_path)
    found = folder.put([object()])
    with pytest.raises(DataError, match="builtins:object cannot be kept"):
        folder.get(found)


@pytest.mark.parametrize(
    ("found", "told"),
    [({"data": "\x00\x01"}, "not a kept value: "), ({"else": 1}, "not a kept value: {'else': 1}")],
)
def test_what_no_run_has_written_is_no_value(tmp_path, found, told):
    with pytest.raises(DataError, match=told):
        ValueFolder(tmp_path).get(found)


def test_up_to_400_bytes_are_kept_in_the_journal_itself(tmp_path):
    folder = ValueFolder(tmp_path / "values")
    room = 400 - len(to_bytes((" ",))) + 1
    assert set(folder.put((room * " ",))) == {"data"}
    assert set(folder.put(((room + 1) * " ",))) == {"file"}
    (file,) = (tmp_path / "values").iterdir()
    assert len(file.name) == 32


@pytest.mark.parametrize("name", ["os:system", "subprocess:Popen", "no_such:Thing", "builtins:int"])
def test_a_class_that_is_no_message_is_refused(name):
    data = to_bytes(Hold(3, np.eye(4), 0.4))
    own = b"executive.messages.hold:Hold"
    other = data.replace(own, name.encode().ljust(len(own)))
    with pytest.raises(DataError):
        from_bytes(other)


@dataclass
class Local:
    a: int


def test_cut_off_bytes_are_refused():
    data = to_bytes([Local(1), np.arange(10)])
    for length in range(len(data)):
        with pytest.raises(DataError):
            from_bytes(data[:length])
