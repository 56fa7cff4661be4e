"""The tables of the database: stones as they are now, and the events of their history."""

import sqlite3
from collections.abc import Iterable, Sequence

import numpy as np
from executive_plugins.objects.surface import unpack

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.pose import transform
from executive.messages.stone import Stone, StoneState
from executive.messages.stone_event import StoneEvent
from executive.messages.weight import Weight

VERSION = 2

TABLES = """
CREATE TABLE stones (
    id INTEGER PRIMARY KEY,
    state TEXT NOT NULL,
    seen_from_above INTEGER NOT NULL,
    points_object BLOB NOT NULL,      -- surface in the object frame [m], (N, 3): zlib of <f4
    T_map_object BLOB NOT NULL,       -- little-endian float64, shape (4, 4)
    T_map_gripper_grasp BLOB          -- gripper at the grasp while the stone is held, else NULL
);
CREATE TABLE events (
    id INTEGER PRIMARY KEY,
    stone_id INTEGER NOT NULL REFERENCES stones(id),
    stamp_s REAL NOT NULL,
    kind TEXT NOT NULL,               -- as `StoneEvent.kind`
    state TEXT NOT NULL,              -- of the stone afterwards
    T_map_object BLOB NOT NULL,       -- afterwards
    note TEXT NOT NULL                -- its origin, for people
);
CREATE INDEX events_of_stone ON events(stone_id);
"""

# Later than the others, and not in files that were written before it.
WEIGHTS = """
CREATE TABLE IF NOT EXISTS weights (
    stone_id INTEGER PRIMARY KEY REFERENCES stones(id),
    mass_kg REAL NOT NULL,
    std_kg REAL NOT NULL,             -- standard deviation
    stamp_s REAL NOT NULL
);
"""

GRASPS = """
CREATE TABLE IF NOT EXISTS grasps (
    id INTEGER PRIMARY KEY,
    stone_id INTEGER NOT NULL REFERENCES stones(id),
    T_object_gripper BLOB NOT NULL,   -- of a grasp that held the stone on its whole way
    stamp_s REAL NOT NULL
);
"""


def create_or_check(connection: sqlite3.Connection, path: str) -> None:
    """Create the tables in a new file, or check the version of an existing one.

    Raises:
        DataError: If the file belongs to another program or another version.
    """
    tables = connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
    if tables == 0 and version_of(connection) == 0:
        connection.executescript(f"BEGIN; {TABLES} PRAGMA user_version = {VERSION}; COMMIT;")
    check(connection, path)


def check(connection: sqlite3.Connection, path: str) -> None:
    """Refuse a file of another program or another version.

    Raises:
        DataError: If so; the message names the file and its version.
    """
    version = version_of(connection)
    if version != VERSION:
        raise DataError(
            f"{path} is not an object database of version {VERSION} (its version is {version}): "
            "choose another file"
        )


def version_of(connection: sqlite3.Connection) -> int:
    """Return the version stored in a file; 0 if there is none."""
    return int(connection.execute("PRAGMA user_version").fetchone()[0])


def pack_pose(T: Float) -> bytes:
    """Return the bytes of a pose."""
    return np.asarray(T, dtype="<f8").tobytes()


def unpack_pose(blob: bytes) -> Float:
    """Return the pose from its bytes, shape (4, 4)."""
    return np.frombuffer(blob, dtype="<f8").reshape(4, 4).astype(np.float64)


def read_weights(connection: sqlite3.Connection) -> dict[int, Weight]:
    """Return the weighed masses by the stones' ids; none in a file without their table."""
    if not _has_table(connection, "weights"):
        return {}
    rows = connection.execute("SELECT stone_id, mass_kg, std_kg FROM weights").fetchall()
    return {row["stone_id"]: Weight(row["mass_kg"], row["std_kg"]) for row in rows}


def read_grasps(connection: sqlite3.Connection) -> dict[int, list[Float]]:
    """Return the grasps that held stones, oldest first, by the stones' ids; none in a file without
    their table.
    """
    found: dict[int, list[Float]] = {}
    if _has_table(connection, "grasps"):
        query = "SELECT stone_id, T_object_gripper FROM grasps ORDER BY id"
        for row in connection.execute(query).fetchall():
            found.setdefault(row["stone_id"], []).append(unpack_pose(row["T_object_gripper"]))
    return found


def _has_table(connection: sqlite3.Connection, name: str) -> bool:
    query = "SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = ?"
    return connection.execute(query, (name,)).fetchone() is not None


def read_stones(connection: sqlite3.Connection, rows: Iterable[sqlite3.Row]) -> tuple[Stone, ...]:
    """Build stones from their rows, what they weigh, and the grasps that held them."""
    weights, grasps = read_weights(connection), read_grasps(connection)
    return tuple(
        _read_stone(row, weights.get(row["id"]), grasps.get(row["id"], ())) for row in rows
    )


def _read_stone(row: sqlite3.Row, weight: Weight | None, grasps: Sequence[Float]) -> Stone:
    T = unpack_pose(row["T_map_object"])
    points = transform(T, unpack(row["points_object"]))
    return Stone(
        id=row["id"],
        state=StoneState(row["state"]),
        points_map=points,
        centroid_map=points.mean(axis=0),
        T_map_object=T,
        seen_from_above=bool(row["seen_from_above"]),
        weight=weight,
        T_object_gripper=np.array(grasps).reshape(-1, 4, 4),
    )


def read_event(row: sqlite3.Row) -> StoneEvent:
    """Build an event from its row."""
    T = unpack_pose(row["T_map_object"])
    return StoneEvent(row["stamp_s"], row["kind"], StoneState(row["state"]), T, row["note"])
