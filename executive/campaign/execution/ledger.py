"""The results of a campaign on disk: what was asked for, begun, and came of it.

Every change is on the disk before the next step (SQLite with a write-ahead log, fully
synchronous), so that a campaign that is killed at any moment goes on from here: a claim whose
campaign has ended counts as not begun, and a result is written once. The lock of the folder is the
lease of all claims: whoever holds it is the only writer.
"""

import json
import sqlite3
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from executive.campaign.execution.disk_space import DiskFullError, is_space_left
from executive.campaign.execution.ledger_rows import (
    FORM,
    SCHEMA,
    SELECT_OUTCOMES,
    SELECT_PENDING,
    SELECT_TRIALS,
    outcome_of,
    outcome_row,
    trial_of,
    trial_row,
)
from executive.campaign.trial import Outcome, Status, Trial
from executive.errors import DataError


class TryState(Enum):
    """What became of one try of a trial."""

    CLAIMED = "claimed"  # begun by the session that works, or by one that was killed
    FINISHED = "finished"  # its outcome is the trial's
    RELEASED = "released"  # stopped with its campaign; it counts for nothing
    LOST = "lost"  # its worker is gone
    PUT_BACK = "put_back"  # its outcome was discarded, to try again


@dataclass(frozen=True, slots=True)
class Session:
    """One time that `executive campaign` worked in the folder.

    Attributes:
        begun: Date and time, UTC, ISO 8601.
        owner: Host and process.
        command: Its command line.
        version: Version of this package.
        source: Fingerprint of the sources of this package.
    """

    begun: str
    owner: str
    command: str
    version: str
    source: str


class Ledger:
    """The ledger of one campaign; the holder of the folder's lock is its only writer."""

    def __init__(self, path: Path, is_read_only: bool = False) -> None:
        """Open it, and make it if it is not there.

        Args:
            path: The file.
            is_read_only: Whether it is opened to be read alone, also where nothing can be written,
                and beside the campaign that writes it.

        Raises:
            DataError: If the file is no ledger, is one of another form, or is to be read and is not
                there.
            DiskFullError: If there is no space for it.
        """
        self._path = path
        self._is_read_only = is_read_only
        self._session = 0
        with self._errors():
            place = f"{path.resolve().as_uri()}?mode={'ro' if is_read_only else 'rwc'}"
            self._database = sqlite3.connect(place, uri=True, isolation_level=None)
        try:
            with self._errors():
                self._set_up()
        except BaseException:
            self._database.close()
            raise

    def _set_up(self) -> None:
        (form,) = self._database.execute("PRAGMA user_version").fetchone()
        (tables,) = self._database.execute("SELECT count(*) FROM sqlite_master").fetchone()
        if tables and form != FORM:
            raise DataError(
                f"{self._path}: its tables are of form {form}, and this version of the package "
                f"reads form {FORM}; use the version that began the campaign, or another folder"
            )
        if not self._is_read_only:
            self._database.execute("PRAGMA journal_mode = WAL")
            self._database.execute("PRAGMA synchronous = FULL")
            self._database.executescript(f"PRAGMA user_version = {FORM};{SCHEMA}")
        self._database.execute("SELECT count(*) FROM trials").fetchone()

    @property
    def digest(self) -> str | None:
        """Hash of the trials that it was made for; None if it is new."""
        with self._errors():
            found = self._database.execute("SELECT value FROM meta WHERE key = 'digest'").fetchone()
        return str(found[0]) if found else None

    def begin(self, trials: Sequence[Trial], digest: str) -> None:
        """Write down what is asked for; arguments, which may be whole missions, only once."""
        numbers: dict[str, int] = {}
        rows = [trial_row(one, numbers) for one in trials]
        with self._transaction() as database:
            database.execute("INSERT INTO meta VALUES ('digest', ?)", (digest,))
            database.executemany(
                "INSERT INTO arguments (text, arguments) VALUES (?, ?)", numbers.items()
            )
            database.executemany("INSERT INTO trials VALUES (?, ?, ?, ?, ?, ?, ?)", rows)

    def add_session(self, session: Session) -> None:
        """Write down who works in the folder from now on."""
        with self._transaction() as database:
            values = (session.begun, session.owner, session.command)
            cursor = database.execute(
                "INSERT INTO sessions (begun, owner, command, version, source)"
                " VALUES (?, ?, ?, ?, ?)",
                (*values, session.version, session.source),
            )
            self._session = cursor.lastrowid or 0

    def sessions(self) -> list[Session]:
        """Return all sessions in their order."""
        with self._errors():
            found = self._database.execute(
                "SELECT begun, owner, command, version, source FROM sessions ORDER BY session"
            )
            return [Session(*row) for row in found]

    def trials(self) -> Iterator[Trial]:
        """Return the trials in their order."""
        with self._errors():
            found = self._database.execute("SELECT arguments, text FROM arguments")
            arguments = {number: json.loads(text) for number, text in found}
            for row in self._database.execute(SELECT_TRIALS):
                yield trial_of(row, arguments)

    def outcomes(self) -> Iterator[Outcome]:
        """Return the outcomes in the order of their trials."""
        with self._errors():
            yield from map(outcome_of, self._database.execute(SELECT_OUTCOMES))

    def counts(self) -> Counter[Status]:
        """Return the number of outcomes by status."""
        with self._errors():
            found = self._database.execute("SELECT status, count(*) FROM outcomes GROUP BY status")
            return Counter({Status(status): count for status, count in found})

    def done(self) -> list[int]:
        """Return the numbers of the trials that have an answer."""
        with self._errors():
            found = self._database.execute("SELECT number FROM outcomes WHERE status = 'done'")
            return [number for (number,) in found]

    def pending(self) -> list[int]:
        """Return the numbers of the trials that are neither finished nor claimed, in order."""
        with self._errors():
            return [number for (number,) in self._database.execute(SELECT_PENDING)]

    def claims(self) -> list[tuple[int, int]]:
        """Return number and try of what is claimed."""
        with self._errors():
            return self._database.execute(
                "SELECT number, try FROM tries WHERE state = 'claimed' ORDER BY number"
            ).fetchall()

    def claim(self, number: int) -> int:
        """Claim a trial, before its run begins; return the number of the try, from 1."""
        with self._transaction() as database:
            last = database.execute("SELECT max(try) FROM tries WHERE number = ?", (number,))
            tries = (last.fetchone()[0] or 0) + 1
            database.execute(
                "INSERT INTO tries VALUES (?, ?, ?, ?, '')",
                (number, tries, self._session, TryState.CLAIMED.value),
            )
            return tries

    def release(self, number: int, state: TryState, reason: str = "") -> None:
        """Give up the claim of a trial, which is pending again."""
        with self._transaction() as database:
            self._close_claim(database, number, state, reason)

    def finish(self, outcome: Outcome) -> None:
        """Write the outcome of a claimed trial.

        Raises:
            sqlite3.IntegrityError: If the trial has an outcome already, or there is no such trial.
        """
        with self._transaction() as database:
            database.execute(
                "INSERT INTO outcomes VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)", outcome_row(outcome)
            )
            self._close_claim(database, outcome.number, TryState.FINISHED, outcome.reason)

    def lost(self, number: int) -> int:
        """Return how many tries of a trial lost their worker since it was put back."""
        with self._errors():
            found = self._database.execute(
                "SELECT count(*) FROM tries WHERE number = ?1 AND state = 'lost' AND try >"
                " (SELECT coalesce(max(try), 0) FROM tries"
                " WHERE number = ?1 AND state = 'put_back')",
                (number,),
            )
            return int(found.fetchone()[0])

    def put_back(self, status: Status) -> int:
        """Discard the outcomes of a status, so that their trials are run again; return how many."""
        with self._transaction() as database:
            database.execute(
                "UPDATE tries SET state = ? WHERE state = 'finished' AND number IN"
                " (SELECT number FROM outcomes WHERE status = ?)",
                (TryState.PUT_BACK.value, status.value),
            )
            return database.execute(
                "DELETE FROM outcomes WHERE status = ?", (status.value,)
            ).rowcount

    def close(self) -> None:
        """Leave one file that can be read from anywhere, also where nothing can be written."""
        if not self._is_read_only:
            with suppress(sqlite3.Error):  # somebody reads it at the moment
                self._database.execute("PRAGMA journal_mode = DELETE")
        self._database.close()

    def _close_claim(
        self, database: sqlite3.Connection, number: int, state: TryState, reason: str
    ) -> None:
        database.execute(
            "UPDATE tries SET state = ?, reason = ? WHERE number = ? AND state = 'claimed'",
            (state.value, reason, number),
        )

    @contextmanager
    def _transaction(self) -> Iterator[sqlite3.Connection]:
        """Do all of it or nothing; it is on the disk afterwards."""
        with self._errors():
            self._database.execute("BEGIN IMMEDIATE")
            try:
                yield self._database
                self._database.execute("COMMIT")
            except BaseException:
                with suppress(sqlite3.Error):  # a full disk may have rolled it back already
                    self._database.execute("ROLLBACK")
                raise

    @contextmanager
    def _errors(self) -> Iterator[None]:
        """Turn what SQLite says of a full disk or of another file into what a person can act on."""
        try:
            yield
        except sqlite3.IntegrityError:
            raise
        except sqlite3.DatabaseError as error:
            if _is_disk_full(error, self._path):
                raise DiskFullError(f"no space is left for {self._path}") from error
            raise DataError(f"{self._path}: {error}") from error


def _is_disk_full(error: sqlite3.DatabaseError, path: Path) -> bool:
    """Return whether space is missing; an error of input or output may hide it."""
    code = getattr(error, "sqlite_errorcode", 0) & 0xFF
    if code == sqlite3.SQLITE_FULL:
        return True
    return code == sqlite3.SQLITE_IOERR and not is_space_left(path.parent)
