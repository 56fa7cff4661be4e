"""The SQLite file of the object database: opening, sharing, and transactions."""

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from executive_plugins.objects.schema import check, create_or_check

from executive.errors import ConfigError, DataError


def open_file(path: str, read_only: bool) -> sqlite3.Connection:
    """Open or create a database; a read-only one may be written by another process meanwhile.

    Raises:
        ConfigError: If its folder does not exist, it cannot be written, or there is none to read.
        DataError: If it is another kind of file.
    """
    connection = _connect_to_read(path) if read_only else _connect_to_write(path)
    connection.row_factory = sqlite3.Row
    try:
        if read_only:
            check(connection, path)
        else:
            # With a write-ahead log, readers and the writer do not wait for each other.
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute("PRAGMA synchronous = FULL")  # a finished change is on the disk
            connection.execute("PRAGMA foreign_keys = ON")
            create_or_check(connection, path)
    except sqlite3.DatabaseError as error:
        connection.close()
        raise DataError(f"{path} is not an object database: {error}") from error
    except DataError:
        connection.close()
        raise
    return connection


@contextmanager
def transaction(connection: sqlite3.Connection) -> Iterator[sqlite3.Connection]:
    """Apply all changes of the block, or none if anything fails."""
    connection.execute("BEGIN IMMEDIATE")
    try:
        yield connection
    except BaseException:
        connection.execute("ROLLBACK")
        raise
    connection.execute("COMMIT")


def _connect_to_write(path: str) -> sqlite3.Connection:
    if path != ":memory:" and not Path(path).absolute().parent.is_dir():
        raise ConfigError(
            f"no folder for the object database {path}: create {Path(path).absolute().parent}"
        )
    try:
        return sqlite3.connect(path, isolation_level=None, check_same_thread=False)
    except sqlite3.Error as error:
        raise ConfigError(f"cannot open the object database {path}: {error}") from error


def _connect_to_read(path: str) -> sqlite3.Connection:
    if not Path(path).is_file():
        raise ConfigError(f"no object database {path}: give the folder of a run with stones")
    address = f"{Path(path).absolute().as_uri()}?mode=ro"
    # A reader of a database with a write-ahead log creates files next to it. Where that is not
    # possible (an archive), the file is opened as immutable, unless the log holds changes.
    log = Path(f"{path}-wal")
    for options in ("", "&immutable=1") if not log.exists() or not log.stat().st_size else ("",):
        connection = sqlite3.connect(
            address + options, uri=True, isolation_level=None, check_same_thread=False
        )
        try:
            connection.execute("SELECT count(*) FROM sqlite_master")
        except sqlite3.OperationalError as error:
            connection.close()
            refusal = error
        except sqlite3.DatabaseError:
            return connection  # another kind of file: the caller reports it
        else:
            return connection
    raise ConfigError(
        f"cannot read the object database {path}: {refusal}; copy its folder to a place that can "
        "be written"
    )
