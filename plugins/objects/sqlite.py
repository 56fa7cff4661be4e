"""The object database in one SQLite file: one transaction a change, so that a killed mission loses nothing."""

import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from pathlib import Path

import numpy as np
from pydantic import Field

from executive.arrays import Float, checked
from executive.config import Meters, Settings
from executive.errors import ConfigError, DataError
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.voxels import voxel_means
from executive.interfaces.objects import ObjectDatabase
from executive.messages.segment import Segment
from executive.messages.stone import Stone, StoneState
from plugins.objects.association import associate
from plugins.objects.schema import pack_pose, prepare, read_stone, unpack_pose
from plugins.objects.surface import agreement, pack, unpack


class SqliteObjectsSettings(Settings):
    """When a segment is a known stone, when its surface grows, and how finely its surface is kept."""

    max_distance_m: Meters = Field(0.6, gt=0, description="Largest distance of a segment from its stone [m].")
    max_roll_m: Meters = Field(3.0, gt=0, description="The same for a stone that fell or was lost [m].")
    max_growth: float = Field(1.6, gt=1, description="Largest ratio of a segment's diagonal to its stone's.")
    voxel_m: Meters = Field(0.03, gt=0, description="Grid to which surfaces are thinned [m].")
    agreement_m: Meters = Field(0.10, gt=0, description="Distance up to which two surfaces agree [m].")
    min_agreement: float = Field(0.6, ge=0, le=1, description="Share that must agree before a surface grows.")


class SqliteObjects(ObjectDatabase):
    """Stones with identities, surfaces and poses (Mascaro 2020, Sec. 4.5)."""

    Settings = SqliteObjectsSettings

    def __init__(self, settings: SqliteObjectsSettings) -> None:
        self._settings = settings
        self._open: sqlite3.Connection | None = None

    def open(self, path: str) -> None:
        """Open or create the file; `:memory:` keeps nothing.

        Raises:
            ConfigError: If its folder does not exist or it cannot be written.
            DataError: If it is another kind of file.
        """
        if self._open is not None:
            raise ConfigError(f"the object database is open already; close it before opening {path}")
        if path != ":memory:" and not Path(path).absolute().parent.is_dir():
            raise ConfigError(f"no folder for the object database {path}: create {Path(path).absolute().parent}")
        try:
            connection = sqlite3.connect(path, isolation_level=None, check_same_thread=False)
        except sqlite3.Error as error:
            raise ConfigError(f"cannot open the object database {path}: {error}") from error
        connection.row_factory = sqlite3.Row
        try:
            prepare(connection, path)
        except sqlite3.DatabaseError as error:
            connection.close()
            raise DataError(f"{path} is no object database: {error}") from error
        except DataError:
            connection.close()
            raise
        self._open = connection

    def close(self) -> None:
        """Close the file; all changes are in it already."""
        if self._open is not None:
            self._open.close()
            self._open = None

    def observe(self, segments: Sequence[Segment], stamp_s: float, seen_from_above: bool) -> tuple[Stone, ...]:
        """Match segments with stones that are not held; see `association` for when they match.

        A stone's surface grows by the segment's points if both agree. If they do not, the stone has moved by itself:
        what is seen replaces what was known, and its frame follows the centroid, its rotation unknown. A stone that was
        let go and not seen since may have rolled away. A lost stone that is seen again lies on the ground.
        """
        known = [stone for stone in self.stones() if stone.state is not StoneState.HELD]
        reaches_m = [self._reach_m(stone) for stone in known]
        partners = associate(segments, known, reaches_m, self._settings.max_growth)
        with self._transaction() as db:
            ids = [
                self._add(db, segment, stamp_s, seen_from_above)
                if row < 0
                else self._update(db, known[row], segment, stamp_s, seen_from_above)
                for segment, row in zip(segments, partners, strict=True)
            ]
        return tuple(self.stone(stone_id) for stone_id in ids)

    def stones(self) -> tuple[Stone, ...]:
        """Return all stones, by id."""
        with closing(self._connection().execute("SELECT * FROM stones ORDER BY id")) as rows:
            return tuple(read_stone(row, unpack(row["points_object"])) for row in rows)

    def stone(self, stone_id: int) -> Stone:
        """Return one stone as it is now."""
        row = self._row(stone_id)
        return read_stone(row, unpack(row["points_object"]))

    def poses(self, stone_id: int) -> tuple[tuple[float, str, Float], ...]:
        """Return the stone's pose history: stamp [s], what it came from, T_map_object; oldest first."""
        self._row(stone_id)
        query = "SELECT stamp_s, source, T_map_object FROM poses WHERE stone_id = ? ORDER BY rowid"
        rows = self._connection().execute(query, (stone_id,)).fetchall()
        return tuple((row["stamp_s"], row["source"], unpack_pose(row["T_map_object"])) for row in rows)

    def grasp(self, stone_id: int, T_map_gripper: Float, stamp_s: float) -> Stone:
        """Note the gripper's pose at the grasp; the stone is held from now on.

        Raises:
            DataError: If it is held already.
        """
        T = checked("T_map_gripper", T_map_gripper, 4, 4)
        if self.stone(stone_id).state is StoneState.HELD:
            raise DataError(f"stone {stone_id} is held already; release it first")
        with self._transaction() as db:
            db.execute("UPDATE stones SET T_map_gripper_grasp = ? WHERE id = ?", (pack_pose(T), stone_id))
            self._note(db, stone_id, stamp_s, "grasp", StoneState.HELD)
        return self.stone(stone_id)

    def release(self, stone_id: int, T_map_gripper: Float, stamp_s: float, state: StoneState) -> Stone:
        """Move the stone by T = T_map_gripper(release) · T_map_gripper(grasp)⁻¹ (Eq. 3).

        Raises:
            DataError: If it is not held, or `state` is held.
        """
        T_release = checked("T_map_gripper", T_map_gripper, 4, 4)
        row = self._row(stone_id)
        if row["state"] != StoneState.HELD or state is StoneState.HELD:
            raise DataError(f"stone {stone_id} is {row['state']}: only a held stone is released, and not to be held")
        T_map_map = T_release @ inverse(unpack_pose(row["T_map_gripper_grasp"]))
        with self._transaction() as db:
            db.execute("UPDATE stones SET T_map_gripper_grasp = NULL WHERE id = ?", (stone_id,))
            self._move(db, row, T_map_map, stamp_s, "release")
            self._note(db, stone_id, stamp_s, "release", state)
        return self.stone(stone_id)

    def realign(self, stone_id: int, T_map_map: Float, stamp_s: float) -> Stone:
        """Move the stone in the map; its state stays."""
        row, T = self._row(stone_id), checked("T_map_map", T_map_map, 4, 4)
        with self._transaction() as db:
            self._move(db, row, T, stamp_s, "realign")
            self._note(db, stone_id, stamp_s, "realign", StoneState(row["state"]))
        return self.stone(stone_id)

    def set_state(self, stone_id: int, state: StoneState, stamp_s: float) -> Stone:
        """Change the stone's state.

        Raises:
            DataError: If it is to be held: a grasp needs the gripper's pose.
        """
        self._row(stone_id)
        if state is StoneState.HELD:
            raise DataError(f"stone {stone_id} is held only by `grasp`, which notes the gripper's pose")
        with self._transaction() as db:
            db.execute("UPDATE stones SET T_map_gripper_grasp = NULL WHERE id = ?", (stone_id,))
            self._note(db, stone_id, stamp_s, "state", state)
        return self.stone(stone_id)

    def _connection(self) -> sqlite3.Connection:
        if self._open is None:
            raise ConfigError("the object database is not open: call `open` with the path of its file")
        return self._open

    @contextmanager
    def _transaction(self) -> Iterator[sqlite3.Connection]:
        db = self._connection()
        db.execute("BEGIN IMMEDIATE")
        try:
            yield db
        except BaseException:
            db.execute("ROLLBACK")
            raise
        db.execute("COMMIT")

    def _row(self, stone_id: int) -> sqlite3.Row:
        row = self._connection().execute("SELECT * FROM stones WHERE id = ?", (stone_id,)).fetchone()
        if row is None:
            known = [str(r["id"]) for r in self._connection().execute("SELECT id FROM stones ORDER BY id")]
            raise DataError(f"no stone {stone_id} in the object database; there is {', '.join(known) or 'none'}")
        return row  # type: ignore[no-any-return]

    def _add(self, db: sqlite3.Connection, segment: Segment, stamp_s: float, seen_from_above: bool) -> int:
        T = pose(None, segment.centroid)
        surface = pack(voxel_means(segment.points - segment.centroid, self._settings.voxel_m))
        cursor = db.execute(
            "INSERT INTO stones (state, seen_from_above, points_object, T_map_object) VALUES (?, ?, ?, ?)",
            (StoneState.ON_GROUND, seen_from_above, surface, pack_pose(T)),
        )
        stone_id = int(cursor.lastrowid or 0)
        self._remember(db, stone_id, stamp_s, "observe", T)
        self._note(db, stone_id, stamp_s, "observe", StoneState.ON_GROUND)
        return stone_id

    def _reach_m(self, stone: Stone) -> float:
        """Return how far a stone may be from where it is believed to be [m]."""
        query = "SELECT source FROM poses WHERE stone_id = ? ORDER BY rowid DESC LIMIT 1"
        source = self._connection().execute(query, (stone.id,)).fetchone()["source"]
        was_let_go = stone.state is StoneState.ON_GROUND and source == "release"
        is_uncertain = was_let_go or stone.state is StoneState.LOST
        return self._settings.max_roll_m if is_uncertain else self._settings.max_distance_m

    def _update(
        self, db: sqlite3.Connection, stone: Stone, segment: Segment, stamp_s: float, seen_from_above: bool
    ) -> int:
        settings, T, seen = self._settings, stone.T_map_object, segment.points
        agreed = agreement(stone.points_map, segment.points, settings.agreement_m) >= settings.min_agreement
        if agreed:
            seen = np.vstack([stone.points_map, segment.points])
        else:
            T = pose(T[:3, :3], T[:3, 3] + segment.centroid - stone.centroid_map)
        surface = pack(voxel_means(transform(inverse(T), seen), settings.voxel_m))
        from_above = seen_from_above or (agreed and stone.seen_from_above)
        db.execute(
            "UPDATE stones SET points_object = ?, seen_from_above = ?, T_map_object = ? WHERE id = ?",
            (surface, from_above, pack_pose(T), stone.id),
        )
        self._remember(db, stone.id, stamp_s, "observe", T)
        self._note(db, stone.id, stamp_s, "observe", _found(stone.state))
        return stone.id

    def _move(self, db: sqlite3.Connection, row: sqlite3.Row, T_map_map: Float, stamp_s: float, source: str) -> None:
        T = T_map_map @ unpack_pose(row["T_map_object"])
        db.execute("UPDATE stones SET T_map_object = ? WHERE id = ?", (pack_pose(T), row["id"]))
        self._remember(db, row["id"], stamp_s, source, T)

    def _remember(self, db: sqlite3.Connection, stone_id: int, stamp_s: float, source: str, T: Float) -> None:
        db.execute("INSERT INTO poses VALUES (?, ?, ?, ?)", (stone_id, stamp_s, source, pack_pose(T)))

    def _note(self, db: sqlite3.Connection, stone_id: int, stamp_s: float, kind: str, state: StoneState) -> None:
        db.execute("UPDATE stones SET state = ? WHERE id = ?", (state, stone_id))
        db.execute("INSERT INTO events VALUES (?, ?, ?, ?)", (stone_id, stamp_s, kind, state))


def _found(state: StoneState) -> StoneState:
    return StoneState.ON_GROUND if state is StoneState.LOST else state
