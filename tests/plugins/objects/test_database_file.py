"""The file of the object database by itself: what it holds together, whatever writes to it."""

import sqlite3
from pathlib import Path

import pytest
from executive_plugins.objects.database_file import open_file, transaction

from executive.errors import ConfigError, DataError


def _write_half(connection: sqlite3.Connection) -> None:
    with transaction(connection) as change:
        change.execute("INSERT INTO notes VALUES ('half')")
        raise KeyboardInterrupt


@pytest.fixture
def connection(tmp_path: Path):
    opened = open_file(str(tmp_path / "objects.db"), read_only=False)
    yield opened
    opened.close()


def test_an_event_belongs_to_a_stone(connection: sqlite3.Connection) -> None:
    columns = [row["name"] for row in connection.execute("PRAGMA table_info(events)")]
    row = [7 if name == "stone_id" else 0 for name in columns]
    with pytest.raises(sqlite3.IntegrityError, match="FOREIGN KEY"):
        connection.execute(f"INSERT INTO events VALUES ({', '.join('?' * len(row))})", row)


def test_a_finished_change_is_on_the_disk_and_readers_do_not_wait(
    connection: sqlite3.Connection,
) -> None:
    (journal,) = connection.execute("PRAGMA journal_mode").fetchone()
    (synchronous,) = connection.execute("PRAGMA synchronous").fetchone()
    assert (journal, synchronous) == ("wal", 2)  # 2 is FULL


def test_a_file_says_that_it_is_of_the_second_format(connection: sqlite3.Connection) -> None:
    """Files of before would not be read by a program that calls it otherwise."""
    assert connection.execute("PRAGMA user_version").fetchone()[0] == 2


def test_a_file_of_another_kind_is_refused_with_its_name(tmp_path: Path) -> None:
    path = tmp_path / "objects.db"
    path.write_bytes(b"a letter, and no database at all: " * 40)
    with pytest.raises(DataError, match=r"objects\.db is not an object database"):
        open_file(str(path), read_only=True)
    with pytest.raises(ConfigError, match="no object database"):
        open_file(str(tmp_path / "none.db"), read_only=True)


def test_rows_are_read_by_name(connection: sqlite3.Connection) -> None:
    assert connection.execute("SELECT 5 AS five").fetchone()["five"] == 5


def test_a_block_that_fails_is_undone_and_the_next_one_is_not(
    connection: sqlite3.Connection,
) -> None:
    connection.execute("CREATE TABLE notes (text TEXT)")
    with pytest.raises(KeyboardInterrupt):
        _write_half(connection)
    with transaction(connection) as change:
        change.execute("INSERT INTO notes VALUES ('whole')")
    assert not connection.in_transaction
    assert [row["text"] for row in connection.execute("SELECT text FROM notes")] == ["whole"]


class _Unopened:
    """A connection to a file whose folder cannot be written: SQLite fails at the first use."""

    def execute(self, *_: object) -> None:
        raise sqlite3.OperationalError("unable to open database file")

    def close(self) -> None:
        pass


@pytest.fixture
def archived(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Return a database in a folder that cannot be written."""
    path = str(tmp_path / "objects.db")
    open_file(path, read_only=False).close()
    connect = sqlite3.connect

    def in_archive(address: str, **options: object) -> object:
        return connect(address, **options) if "immutable" in address else _Unopened()

    monkeypatch.setattr("executive_plugins.objects.database_file.sqlite3.connect", in_archive)
    return path


def test_a_database_in_an_archive_is_read_as_it_is(archived: str) -> None:
    opened = open_file(archived, read_only=True)
    assert opened.execute("SELECT count(*) AS n FROM stones").fetchone()["n"] == 0
    with pytest.raises(sqlite3.OperationalError, match="readonly"):
        opened.execute("DELETE FROM stones")
    opened.close()


def test_an_archive_with_changes_in_its_log_must_be_copied(archived: str) -> None:
    Path(f"{archived}-wal").write_bytes(b"changes")
    with pytest.raises(ConfigError, match="copy its folder to a place that can be written"):
        open_file(archived, read_only=True)
