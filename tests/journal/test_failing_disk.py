"""A disk that fails while a run is kept is told; what was kept stays, and nothing else stops."""

import os
import time
from dataclasses import dataclass, field

import numpy as np
import pytest

from executive.errors import DataError
from executive.events.mission import PhaseChanged
from executive.journal import Journal
from executive.journal.entry import FIRST_CHECKSUM, Entry, entry_of, line_of
from executive.journal.value_codec import WALL_TIME, NotKeptError, decode, encode
from executive.journal.value_file import from_bytes, to_bytes
from executive.journal.value_folder import ValueFolder

EVENT = PhaseChanged("idle", "running", "")
LARGE = np.arange(1000.0)


def full(*_args, **_more):
    raise OSError(28, "No space left on device")


def test_a_disk_that_does_not_take_a_secured_line_is_told_and_listeners_hear_on(
    tmp_path, monkeypatch
):
    journal, heard = Journal(tmp_path / "journal.jsonl"), []
    journal.follow(heard.append)
    journal.append(0, 0.0, "", EVENT)
    monkeypatch.setattr(os, "fdatasync", full)
    journal.secure()
    assert journal.failure is not None
    assert journal.failure.errno == 28
    journal.append(1, 0.05, "", EVENT)
    journal.secure()  # nothing is waited for any more
    assert [entry.sequence for entry in heard] == [0, 1]
    assert journal.last is heard[-1]
    journal.close()


def test_an_empty_journal_has_no_last_entry():
    journal = Journal()
    assert (journal.last, journal.length, journal.since(0)) == (None, 0, [])
    journal.secure()
    assert journal.failure is None


def test_a_segment_that_cannot_be_compressed_stays_and_is_told(tmp_path, monkeypatch):
    monkeypatch.setattr("executive.journal.segment_file.SEGMENT_BYTES", 500)
    monkeypatch.setattr("executive.journal.segment_file.compress", full)
    journal = Journal(tmp_path / "journal.jsonl")
    for i in range(6):
        journal.append(i, 0.0, "", EVENT)
    until_s = time.monotonic() + 30.0
    while journal.failure is None and time.monotonic() < until_s:
        journal.secure()  # it is told to whoever waits next
    journal.close()
    assert isinstance(journal.failure, OSError)
    assert list(tmp_path.glob("*.gz")) == []
    lines = [
        line
        for path in (*sorted(tmp_path.glob("journal.0*.jsonl")), tmp_path / "journal.jsonl")
        for line in path.read_text().splitlines()
    ]
    assert len(lines) == 6


def test_a_value_that_does_not_fit_on_the_disk_is_told_and_none_that_is_there(
    tmp_path, monkeypatch
):
    folder = ValueFolder(tmp_path / "values")
    kept = folder.put(LARGE)
    monkeypatch.setattr("pathlib.Path.write_bytes", full)
    assert folder.put(LARGE) == kept  # it is there already
    assert folder.failure is None
    lost = folder.put(LARGE + 1)
    assert folder.failure is not None
    assert folder.failure.errno == 28
    with pytest.raises(DataError, match="a kept value cannot be read"):
        folder.get(lost)


def test_kept_values_are_synced_once_when_they_are_secured(tmp_path, monkeypatch):
    synced = []
    monkeypatch.setattr(os, "fdatasync", lambda file: synced.append(os.fstat(file).st_size))
    folder = ValueFolder(tmp_path / "values")
    folder.put(LARGE)
    assert synced == []
    folder.secure()
    folder.secure()
    (file,) = (tmp_path / "values").iterdir()
    assert synced == [file.stat().st_size]


@pytest.mark.parametrize("value", [None, True, 3, 0.5, "stone"])
def test_plain_values_stand_for_themselves(tmp_path, value):
    folder = ValueFolder(tmp_path / "values")
    assert folder.put(value) is value
    assert folder.get(value) is value
    assert not (tmp_path / "values").exists()


@pytest.mark.parametrize(
    ("found", "told"),
    [
        ({"$": "sort", "items": []}, "not a kept value: unknown mark 'sort'"),
        ({"$": "array", "number": 1}, "not a kept value: "),
        ({"$": "tuple"}, "not a kept value: 'items'"),
        ({}, "not a kept value: '[$]'"),
        ({"$": "class", "class": "nowhere:Thing", "fields": {}}, "the class nowhere:Thing of a k"),
        ({"$": "enum", "class": f"{__name__}:Timed", "value": 1}, "of a kept value is not known"),
    ],
)
def test_what_is_no_kept_value_is_refused(found, told):
    with pytest.raises(DataError, match=told):
        decode(found, [np.zeros(1)])


def test_an_array_of_other_than_numbers_is_not_kept():
    with pytest.raises(NotKeptError, match="an array of <U1 cannot be kept"):
        encode(np.array(["a"]), [])
    with pytest.raises(NotKeptError, match="an array of object cannot be kept"):
        encode({"a": [np.array([None])]}, [])


@dataclass
class Timed:
    """A value with a time on the wall."""

    number: int
    twice: int = field(init=False)
    wall_s: float = field(default=0.0, metadata={WALL_TIME: True})

    def __post_init__(self):
        self.twice = 2 * self.number


def test_times_on_the_wall_are_not_kept_and_what_is_made_of_others_is_made_again():
    assert to_bytes(Timed(3, wall_s=1.0)) == to_bytes(Timed(3, wall_s=2.0))
    assert from_bytes(to_bytes(Timed(3, wall_s=1.0))) == Timed(3)


def test_bytes_of_another_kind_are_no_value():
    data = to_bytes((1, LARGE))
    for other in (b"", data[:8], data[:16], b"kept v2\n" + data[8:], data + b"x", data[:-1]):
        with pytest.raises(DataError, match=r"not a kept value|a kept value is cut off"):
            from_bytes(other)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (('"tick":3', '"tick":"3"'), "tick, time or node is of another kind"),
        (('"time_s":0.15', '"time_s":NaN'), "tick, time or node is of another kind"),
        (('"time_s":0.15', '"time_s":1e300'), "tick, time or node is of another kind"),
        (('"node":"main"', '"node":7'), "tick, time or node is of another kind"),
        (('"tick":3', '"tick":4'), "the line or one before it was changed or lost"),
        (('"tick":3', '"tack":3'), "not a line of a journal: 'tick'"),
        (("{", "["), "not a line of a journal: "),
        (('"kind":"phase_changed"', '"kind":3'), ""),
    ],
)
def test_a_line_of_another_form_is_refused(change, told):
    line, checksum = line_of(Entry(5, 3, 0.15, "main", EVENT), FIRST_CHECKSUM)
    entry, stated = entry_of(line, FIRST_CHECKSUM, 5)
    assert (entry.sequence, entry.tick, entry.time_s, entry.node) == (5, 3, 0.15, "main")
    assert (entry.event.payload(), stated) == (EVENT.payload(), checksum)
    assert change[0] in line
    with pytest.raises(DataError) as caught:
        entry_of(line.replace(*change, 1), FIRST_CHECKSUM, 5)
    assert told in str(caught.value)


def test_a_line_of_another_number_or_after_another_line_is_refused():
    line, _ = line_of(Entry(5, 3, 0.15, "main", EVENT), FIRST_CHECKSUM)
    for before, number in ((FIRST_CHECKSUM, 4), (FIRST_CHECKSUM, 6), ("f" * 16, 5)):
        with pytest.raises(DataError, match="was changed or lost"):
            entry_of(line, before, number)


def test_a_line_holds_letters_of_any_language_as_they_are():
    line, checksum = line_of(Entry(0, 0, 0.0, "Hügel", EVENT), FIRST_CHECKSUM)
    assert '"node":"Hügel"' in line
    entry, stated = entry_of(line, FIRST_CHECKSUM, 0)
    assert (entry.node, stated) == ("Hügel", checksum)
