"""The newest of values that are written often: whole, whatever ends the process that writes."""

import pytest

from executive.journal.newest_file import NewestFile, newest_in


@pytest.fixture
def path(tmp_path):
    return tmp_path / "machine"


def test_the_newest_value_is_read(path):
    file = NewestFile(path)
    for value in (b"one, a long value", b"two", b"three"):
        file.write(value)
        assert newest_in(path) == value
    file.close()
    assert newest_in(path) == b"three"


def test_nothing_is_read_where_nothing_was_written(path):
    assert newest_in(path) is None


@pytest.mark.parametrize("cut", [3, 12, 21])
def test_a_value_that_was_cut_off_leaves_the_one_before(path, cut):
    file = NewestFile(path)
    file.write(b"before")
    file.write(b"after")
    newest = path.with_name("machine.0")  # the second value
    newest.write_bytes(newest.read_bytes()[:cut])
    assert newest_in(path) == b"before"


def test_a_value_that_was_overwritten_in_part_leaves_the_one_before(path):
    file = NewestFile(path)
    for value in (b"first", b"second", b"third"):
        file.write(value)
    newest = path.with_name("machine.1")
    data = bytearray(newest.read_bytes())
    data[-1] ^= 1
    newest.write_bytes(data)
    assert newest_in(path) == b"second"


def test_another_process_goes_on_after_the_newest_value(path):
    NewestFile(path).write(b"first")
    NewestFile(path).write(b"second")
    assert newest_in(path) == b"second"
