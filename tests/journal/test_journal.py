"""The journal is exact, complete, and shows any damage."""

import gzip
import json
import os
import resource
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np
import pytest

from executive.arrays import Float
from executive.errors import DataError
from executive.events.event import _KINDS, Event, UnknownEvent, event_from, plain
from executive.events.mission import PhaseChanged
from executive.journal import Journal, JournalFile, read_journal, segment_file
from executive.messages.structure import Structure


@dataclass(frozen=True, slots=True, eq=False)
class Measured(Event):
    """An event of these tests."""

    value: int
    array: Float
    pi: float


def line_of(entry):
    return (entry.sequence, entry.tick, entry.time_s, entry.node, entry.kind, entry.event.payload())


def write(path, n=5):
    journal = Journal(path)
    for i in range(n):
        journal.append(
            i, 0.05 * i, f"main/{i}:Leaf", Measured(i, np.arange(3.0), np.float64(np.pi))
        )
    journal.close()
    return journal


def test_reads_back_what_was_written(tmp_path):
    path = tmp_path / "journal.jsonl"
    written = write(path).newest
    read = list(read_journal(path))
    assert [line_of(entry) for entry in read] == [line_of(entry) for entry in written]
    assert [entry.event.value for entry in read] == list(range(5))
    assert all(isinstance(entry.event, Measured) for entry in read)


def test_an_event_of_a_package_that_is_not_there_is_read_as_unknown(tmp_path):
    path = tmp_path / "journal.jsonl"
    write(path)
    _KINDS.pop("measured")
    try:
        first = next(iter(read_journal(path)))
    finally:
        _KINDS["measured"] = Measured
    assert isinstance(first.event, UnknownEvent)
    assert (first.kind, first.event.values["value"]) == ("measured", 0)


@pytest.mark.parametrize(
    ("payload", "words"),
    [
        ({"value": 1, "array": []}, "lacks its field 'pi'"),
        ({"value": 1, "array": [], "pi": 3.1, "e": 2.7}, "has no field 'e'"),
        ({"value": "one", "array": [], "pi": 3.1}, "field 'value': expected int, got 'one'"),
        ({"value": True, "array": [], "pi": 3.1}, "field 'value': expected int, got True"),
    ],
)
def test_an_event_of_another_form_is_refused_with_its_field(payload, words):
    with pytest.raises(DataError, match=words):
        event_from("measured", payload)


def test_every_event_of_the_executive_comes_back_as_itself():
    """Sample values are made from the fields' types; none may be lost on the way to JSON."""
    kinds = [kind for kind in _KINDS.values() if kind.__module__.startswith("executive.events")]
    assert len(kinds) > 30
    for kind in kinds:
        if kind is UnknownEvent:
            continue
        event = kind(**{f.name: sample(get_type_hints(kind)[f.name]) for f in fields(kind)})
        payload = json.loads(json.dumps(event.payload()))
        again = event_from(event.kind, payload)
        assert type(again) is kind
        assert again.payload() == payload


def sample(kind):
    """Return a value of a type."""
    origin, arguments = get_origin(kind), get_args(kind)
    if origin is np.ndarray:
        return np.arange(3.0)
    if origin is tuple and arguments[-1] is not Ellipsis:
        return tuple(sample(one) for one in arguments)
    if origin is tuple:
        return (sample(arguments[0]),) * 2
    if origin in (Union, UnionType):  # the last one: what was tried before it has to be passed over
        return sample(arguments[-1] if arguments[-1] is not type(None) else arguments[0])
    if origin is Literal:
        return arguments[0]
    if origin is not None:
        return {"a": sample(arguments[1])}
    if kind is Structure:  # its line has rows of two
        return Structure("wall", np.zeros((1, 2)), thickness_m=1.0, height_m=1.0)
    if is_dataclass(kind):
        return kind(**{f.name: sample(get_type_hints(kind)[f.name]) for f in fields(kind)})
    if issubclass(kind, Enum):
        return next(iter(kind))
    return {int: 3, float: 0.5, bool: True, str: "text", Any: "any", object: "any"}[kind]


def test_the_same_entries_give_the_same_bytes(tmp_path):
    write(tmp_path / "a")
    write(tmp_path / "b")
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


@pytest.mark.parametrize(
    "damage",
    [
        lambda lines: [*lines[:2], lines[2].replace('"value":2', '"value":9'), *lines[3:]],
        lambda lines: [*lines[:2], *lines[3:]],
        lambda lines: [lines[1], lines[0], *lines[2:]],
        lambda lines: [*lines[:3], lines[3][:20], lines[4]],
        lambda lines: [*lines[:3], "[]", *lines[3:]],
    ],
    ids=["changed", "lost", "swapped", "cut", "foreign"],
)
def test_shows_damage_and_names_the_line(tmp_path, damage):
    path = tmp_path / "journal.jsonl"
    write(path)
    path.write_text("\n".join([*damage(path.read_text().splitlines()), ""]))
    with pytest.raises(DataError, match=r"journal\.jsonl:\d+:"):
        list(read_journal(path))


def test_a_line_is_on_its_way_to_the_disk_at_once(tmp_path):
    path = tmp_path / "journal.jsonl"
    journal = Journal(path)
    journal.append(0, 0.0, "", PhaseChanged("idle", "running", ""))
    assert json.loads(path.read_text())["kind"] == "phase_changed"
    journal.close()


def test_makes_plain_what_json_does_not_hold():
    assert plain({"a": np.eye(2), "b": (np.int64(1), None), 3: np.bool_(True)}) == {
        "a": [[1.0, 0.0], [0.0, 1.0]],
        "b": [1, None],
        "3": True,
    }


def test_a_last_line_that_was_cut_off_is_left_out_and_told(tmp_path):
    path = tmp_path / "journal.jsonl"
    write(path)
    whole = path.read_bytes()
    path.write_bytes(whole[:-30])
    file = JournalFile(path)
    assert [entry.sequence for entry in file.entries()] == [0, 1, 2, 3]
    assert file.whole_bytes + file.cut_off == len(whole) - 30
    assert whole[: file.whole_bytes].endswith(b"\n")


def test_a_journal_is_continued_where_it_was_cut_off(tmp_path):
    path = tmp_path / "journal.jsonl"
    write(path, 3)
    file = JournalFile(path)
    *_, last = file.entries()
    again = Journal(path)
    again.go_on_after(last, file.checksum)
    again.append(9, 0.45, "", PhaseChanged("idle", "running", ""))
    again.close()
    assert [entry.sequence for entry in read_journal(path)] == [0, 1, 2, 3]


def test_a_long_journal_is_written_in_parts_that_are_read_as_one(tmp_path, monkeypatch):
    monkeypatch.setattr(segment_file, "SEGMENT_BYTES", 1000)
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        write(tmp_path / name / "journal.jsonl", 50)
    parts = sorted((tmp_path / "a").iterdir())
    assert len(parts) > 5
    assert [entry.event.value for entry in read_journal(tmp_path / "a" / "journal.jsonl")] == list(
        range(50)
    )
    unpacked = [b"".join(unpack(one) for one in sorted((tmp_path / n).iterdir())) for n in "ab"]
    assert unpacked[0] == unpacked[1]


def test_a_part_that_is_lost_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(segment_file, "SEGMENT_BYTES", 1000)
    write(tmp_path / "journal.jsonl", 50)
    next(iter(tmp_path.glob("journal.0002*"))).unlink()
    with pytest.raises(DataError, match=r"journal\.0003\.jsonl.*:1: .*changed or lost"):
        list(read_journal(tmp_path / "journal.jsonl"))


def unpack(path):
    return gzip.decompress(path.read_bytes()) if path.suffix == ".gz" else path.read_bytes()


def test_memory_is_bounded_and_followers_see_every_entry():
    journal, seen = Journal(), []
    journal.follow(lambda entry: seen.append(entry.sequence))
    for i in range(12_000):
        journal.append(i, 0.05 * i, "", PhaseChanged("idle", "running", ""))
    assert seen == list(range(12_000))
    assert len(journal.newest) == 5000
    assert [entry.sequence for entry in journal.since(11_998)] == [11_998, 11_999]


def test_a_full_disk_leaves_whole_lines_and_says_so(tmp_path):
    """A limit on the size of a file is what a test can set of a full disk."""
    path = tmp_path / "journal.jsonl"
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    journal = Journal(path)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
        for i in range(50):
            journal.append(i, 0.05 * i, "", PhaseChanged("idle", "running", ""))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        journal.close()
    assert isinstance(journal.failure, OSError)
    file = JournalFile(path)
    assert 3 < len(list(file.entries())) < 10
    assert file.cut_off == 0
    assert len(journal.newest) == 50


def test_a_secured_line_was_synced(tmp_path, monkeypatch):
    synced, real = [], os.fdatasync

    def sync(file):
        synced.append(os.fstat(file).st_size)
        real(file)

    monkeypatch.setattr(os, "fdatasync", sync)
    journal = Journal(tmp_path / "journal.jsonl")
    journal.append(0, 0.0, "", PhaseChanged("idle", "running", ""))
    journal.secure()
    assert synced[-1] == (tmp_path / "journal.jsonl").stat().st_size
    journal.close()
