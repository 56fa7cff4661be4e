"""The database's tables: stones as they are, every pose they had, and what happened to them."""

import sqlite3

import numpy as np

from executive.arrays import Float
from executive.errors import DataError
from executive.geometry.pose import transform
from executive.messages.stone import Stone, StoneState

VERSION = 1

TABLES = """
CREATE TABLE stones (
    id INTEGER PRIMARY KEY,
    state TEXT NOT NULL,
    seen_from_above INTEGER NOT NULL,
    points_object BLOB NOT NULL,      -- surface in the object frame [m]: zlib of little-endian float32, shape (N, 3)
    T_map_object BLOB NOT NULL,       -- little-endian float64, shape (4, 4)
    T_map_gripper_grasp BLOB          -- pose of the gripper at the grasp while the stone is held, else NULL
);
CREATE TABLE poses (
    stone_id INTEGER NOT NULL REFERENCES stones(id),
    stamp_s REAL NOT NULL,
    source TEXT NOT NULL,             -- observe | release | realign
    T_map_object BLOB NOT NULL
);
CREATE TABLE events (
    stone_id INTEGER NOT NULL REFERENCES stones(id),
    stamp_s REAL NOT NULL,
    kind TEXT NOT NULL,               -- observe | grasp | release | realign | state
    state TEXT NOT NULL               -- of the stone afterwards
);
CREATE INDEX poses_of_stone ON poses(stone_id);
CREATE INDEX events_of_stone ON events(stone_id);
"""


def prepare(connection: sqlite3.Connection, path: str) -> None:
    """Create the tables in a new file, or check those of an old one.

    Raises:
        DataError: If the file belongs to another program or another version.
    """
    connection.execute("PRAGMA journal_mode = WAL")
    connection.execute("PRAGMA synchronous = FULL")  # what returned is on the disk
    connection.execute("PRAGMA foreign_keys = ON")
    version = connection.execute("PRAGMA user_version").fetchone()[0]
    tables = connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
    if version == 0 and tables == 0:
        connection.executescript(f"BEGIN; {TABLES} PRAGMA user_version = {VERSION}; COMMIT;")
    elif version != VERSION:
        raise DataError(f"{path} is no object database of version {VERSION} (it says {version}): choose another file")


def pack_pose(T: Float) -> bytes:
    """Return a pose as bytes."""
    return np.asarray(T, dtype="<f8").tobytes()


def unpack_pose(blob: bytes) -> Float:
    """Return a pose from its bytes, shape (4, 4)."""
    return np.frombuffer(blob, dtype="<f8").reshape(4, 4).astype(np.float64)


def read_stone(row: sqlite3.Row, points_object: Float) -> Stone:
    """Assemble a stone from its row and its surface in the object frame."""
    T = unpack_pose(row["T_map_object"])
    points = transform(T, points_object)
    return Stone(
        id=row["id"],
        state=StoneState(row["state"]),
        points_map=points,
        centroid_map=points.mean(axis=0),
        T_map_object=T,
        seen_from_above=bool(row["seen_from_above"]),
    )
