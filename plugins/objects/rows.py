"""The row of a stone, and the changes of it that the database's verbs consist of."""

import sqlite3

from executive_plugins.objects.schema import GRASPS, pack_pose, unpack_pose

from executive.arrays import Float
from executive.errors import DataError
from executive.messages.stone import StoneState


def row_of(connection: sqlite3.Connection, stone_id: int) -> sqlite3.Row:
    """Return the row of a stone.

    Raises:
        DataError: If there is none; the message names those that there are.
    """
    row = connection.execute("SELECT * FROM stones WHERE id = ?", (stone_id,)).fetchone()
    if row is None:
        known = [str(r["id"]) for r in connection.execute("SELECT id FROM stones ORDER BY id")]
        raise DataError(
            f"no stone {stone_id} in the object database; there is {', '.join(known) or 'none'}"
        )
    return row  # type: ignore[no-any-return]


def move_row(db: sqlite3.Connection, row: sqlite3.Row, T_map_map: Float) -> None:
    """Move a stone in the map, T_map_map of shape (4, 4)."""
    T = T_map_map @ unpack_pose(row["T_map_object"])
    db.execute("UPDATE stones SET T_map_object = ? WHERE id = ?", (pack_pose(T), row["id"]))


def add_event(
    db: sqlite3.Connection,
    stone_id: int,
    stamp_s: float,
    kind: str,
    state: StoneState,
    note: str = "",
) -> None:
    """Set a stone's state, and write an event with its pose into its history."""
    db.execute("UPDATE stones SET state = ? WHERE id = ?", (state, stone_id))
    db.execute(
        "INSERT INTO events (stone_id, stamp_s, kind, state, T_map_object, note) "
        "SELECT id, ?, ?, ?, T_map_object, ? FROM stones WHERE id = ?",
        (stamp_s, kind, state, note, stone_id),
    )


def add_grasp(db: sqlite3.Connection, stone_id: int, T: Float, stamp_s: float) -> None:
    """Keep a pose of the gripper in a stone's frame, shape (4, 4), that has held it."""
    db.execute(GRASPS)  # a file of an older run has no table for it
    db.execute(
        "INSERT INTO grasps (stone_id, T_object_gripper, stamp_s) VALUES (?, ?, ?)",
        (stone_id, pack_pose(T), stamp_s),
    )


def forget_grasps(db: sqlite3.Connection, stone_id: int) -> None:
    """Delete the grasps that held a stone."""
    db.execute(GRASPS)
    db.execute("DELETE FROM grasps WHERE stone_id = ?", (stone_id,))
