"""The journal is exact, complete, and shows any damage."""

import json

import numpy as np
import pytest

from executive.errors import DataError
from executive.journal import Journal, plain, read_journal


def write(path, n=5):
    journal = Journal(path)
    for i in range(n):
        payload = {"value": i, "array": np.arange(3), "pi": np.float64(np.pi)}
        journal.append(i, 0.05 * i, "kind", f"main/{i}:Leaf", payload)
    journal.close()
    return journal


def test_reads_back_what_was_written(tmp_path):
    path = tmp_path / "journal.jsonl"
    written = write(path).entries
    assert list(read_journal(path)) == written
    assert [entry.payload["value"] for entry in written] == list(range(5))


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
        lambda lines: [*lines[:4], lines[4][:20]],
        lambda lines: [*lines[:3], "[]", *lines[3:]],
    ],
    ids=["changed", "lost", "swapped", "cut", "foreign"],
)
def test_shows_damage_and_names_the_line(tmp_path, damage):
    path = tmp_path / "journal.jsonl"
    write(path)
    path.write_text("\n".join(damage(path.read_text().splitlines())))
    with pytest.raises(DataError, match=r"journal\.jsonl:\d+:"):
        list(read_journal(path))


def test_a_line_is_on_its_way_to_the_disk_at_once(tmp_path):
    path = tmp_path / "journal.jsonl"
    journal = Journal(path)
    journal.append(0, 0.0, "phase", "", {})
    assert json.loads(path.read_text())["kind"] == "phase"
    journal.close()


def test_makes_plain_what_json_does_not_hold():
    assert plain({"a": np.eye(2), "b": (np.int64(1), None), 3: np.bool_(True)}) == {
        "a": [[1.0, 0.0], [0.0, 1.0]],
        "b": [1, None],
        "3": True,
    }
