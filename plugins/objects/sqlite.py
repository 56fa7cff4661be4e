"""The object database in one SQLite file.

Each change is one transaction, so a mission that is killed loses nothing.
"""

import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager

from executive_plugins.objects.association import associate_known_first, carried_m
from executive_plugins.objects.database_file import open_file, transaction
from executive_plugins.objects.growth import Fit, fit_of, icp_shift, merged, shifts_of
from executive_plugins.objects.scene import surface_within, surroundings, unexplained
from executive_plugins.objects.schema import (
    WEIGHTS,
    pack_pose,
    read_event,
    read_stone,
    read_weights,
    unpack_pose,
)
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.surface import pack

from executive.arrays import Float, checked
from executive.errors import ConfigError, DataError
from executive.geometry.pose import inverse, pose, transform
from executive.interfaces.objects import ObjectDatabase
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment
from executive.messages.stone import Stone, StoneState
from executive.messages.stone_event import StoneEvent
from executive.messages.weight import Weight


class SqliteObjects(ObjectDatabase):
    """Stones with identities, surfaces and poses (Mascaro 2020, Sec. 4.5)."""

    Settings = SqliteObjectsSettings

    def __init__(self, settings: SqliteObjectsSettings) -> None:
        self._settings = settings
        self._open: sqlite3.Connection | None = None
        self._is_read_only = False

    def open(self, path: str, read_only: bool = False) -> None:
        """Open or create the file, see `open_file`; `:memory:` stores nothing on disk."""
        if self._open is not None:
            raise ConfigError(
                f"the object database is open already; close it before opening {path}"
            )
        self._open = open_file(path, read_only)
        self._is_read_only = read_only

    def close(self) -> None:
        """Close the file; all changes have been written already."""
        if self._open is not None:
            self._open.close()
            self._open = None

    def observe(
        self, segments: Sequence[Segment], stamp_s: float, seen_from_above: bool
    ) -> tuple[Stone, ...]:
        """Match segments with stones that are not held, and update these; see `association`.

        A segment whose overlap and RMSE pass the gate extends the surface of its stone, unless the
        box would grow too much: such a segment is two stones in one and changes nothing. A segment
        that does not pass shows that the stone has moved. If it passes after a shift, the stone was
        pushed. Otherwise it was turned: the seen surface replaces the known one and the frame
        follows the centroid, while the rotation is unknown. A stone that was released and not seen
        since may have rolled away; one that is lost may lie anywhere on the way that it was carried
        last. A lost stone that is seen again is on the ground.
        """
        if any(not len(segment.points) for segment in segments):
            raise DataError("a segment without points is no stone")
        known = [stone for stone in self.stones() if stone.state is not StoneState.HELD]
        reaches_m = [self._reach_m(stone) for stone in known]
        partners = associate_known_first(segments, known, reaches_m, self._settings.max_growth)
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
            weights = read_weights(self._connection())
            return tuple(read_stone(row, weights.get(row["id"])) for row in rows)

    def stone(self, stone_id: int) -> Stone:
        """Return one stone as it is now."""
        return read_stone(self._row(stone_id), read_weights(self._connection()).get(stone_id))

    def history(self, stone_id: int) -> tuple[StoneEvent, ...]:
        """Return the events of a stone, oldest first."""
        self._row(stone_id)
        rows = (
            self._connection()
            .execute("SELECT * FROM events WHERE stone_id = ? ORDER BY id", (stone_id,))
            .fetchall()
        )
        return tuple(read_event(row) for row in rows)

    def grasp(self, stone_id: int, T_map_gripper: Float, stamp_s: float) -> Stone:
        """Store the pose of the gripper at the grasp; the stone is held from now on.

        Raises:
            DataError: If it is held already.
        """
        T = checked("T_map_gripper", T_map_gripper, 4, 4)
        if self.stone(stone_id).state is StoneState.HELD:
            raise DataError(f"stone {stone_id} is held already; release it first")
        with self._transaction() as db:
            db.execute(
                "UPDATE stones SET T_map_gripper_grasp = ? WHERE id = ?", (pack_pose(T), stone_id)
            )
            self._note(db, stone_id, stamp_s, "grasp", StoneState.HELD)
        return self.stone(stone_id)

    def release(
        self, stone_id: int, T_map_gripper: Float, stamp_s: float, state: StoneState
    ) -> Stone:
        """Move the stone by T = T_map_gripper(release) · T_map_gripper(grasp)⁻¹ (Eq. 3).

        Raises:
            DataError: If it is not held, or `state` is held.
        """
        T_release = checked("T_map_gripper", T_map_gripper, 4, 4)
        row = self._row(stone_id)
        if row["state"] != StoneState.HELD or state is StoneState.HELD:
            raise DataError(
                f"stone {stone_id} is {row['state']}: only a held stone can be released, "
                "to another state than held"
            )
        T_map_map = T_release @ inverse(unpack_pose(row["T_map_gripper_grasp"]))
        with self._transaction() as db:
            db.execute("UPDATE stones SET T_map_gripper_grasp = NULL WHERE id = ?", (stone_id,))
            self._move(db, row, T_map_map)
            self._note(db, stone_id, stamp_s, "release", state, "by the gripper's motion")
        return self.stone(stone_id)

    def realign(self, stone_id: int, T_map_map: Float, stamp_s: float, note: str = "") -> Stone:
        """Move the stone in the map; its state is kept."""
        row, T = self._row(stone_id), checked("T_map_map", T_map_map, 4, 4)
        with self._transaction() as db:
            self._move(db, row, T)
            self._note(db, stone_id, stamp_s, "realign", StoneState(row["state"]), note)
        return self.stone(stone_id)

    def weigh(self, stone_id: int, weight: Weight, stamp_s: float) -> Stone:
        """Store what the stone weighs; the newest weight counts."""
        self._row(stone_id)
        with self._transaction() as db:
            db.execute(WEIGHTS)  # a file of an older run has no table for it
            db.execute(
                "INSERT OR REPLACE INTO weights VALUES (?, ?, ?, ?)",
                (stone_id, weight.mass_kg, weight.std_kg, stamp_s),
            )
        return self.stone(stone_id)

    def set_state(self, stone_id: int, state: StoneState, stamp_s: float) -> Stone:
        """Change the state of the stone.

        Raises:
            DataError: If the new state is held: a grasp needs the pose of the gripper.
        """
        self._row(stone_id)
        if state is StoneState.HELD:
            raise DataError(
                f"stone {stone_id}: use `grasp` to hold it, which stores the pose of the gripper"
            )
        with self._transaction() as db:
            db.execute("UPDATE stones SET T_map_gripper_grasp = NULL WHERE id = ?", (stone_id,))
            self._note(db, stone_id, stamp_s, "state", state)
        return self.stone(stone_id)

    def surroundings(self, map_cloud: Cloud, without: int | None = None) -> Cloud:
        """Return the map merged with the lying stones' models, one point a cell of `voxel_m`."""
        own = None if without is None else self.stone(without)
        s = self._settings
        points = surroundings(map_cloud.points, self.stones(), own, s.voxel_m, s.ground_m)
        return Cloud(map_cloud.frame, points)

    def unexplained(self, map_cloud: Cloud, stone_id: int, radius_m: float) -> Cloud:
        """Return the map around a stone without the points of other lying stones."""
        around = map_cloud.near(self.stone(stone_id).centroid_map, radius_m)
        s, others = self._settings, self._lying(stone_id)
        points = unexplained(around.points, others, s.explained_m, s.ground_m)
        return Cloud(map_cloud.frame, points)

    def surface_within(
        self, centre_map: Float, radius_m: float, without: int | None = None
    ) -> Float:
        """Return the points of lying stones' models that are in a sphere."""
        return surface_within(self._lying(without), checked("centre_map", centre_map, 3), radius_m)

    def _lying(self, without: int | None) -> list[Stone]:
        return [s for s in self.stones() if s.id != without and s.state.is_lying]

    def _connection(self) -> sqlite3.Connection:
        if self._open is None:
            raise ConfigError(
                "the object database is not open: call `open` with the path of its file"
            )
        return self._open

    @contextmanager
    def _transaction(self) -> Iterator[sqlite3.Connection]:
        db = self._connection()
        if self._is_read_only:
            raise ConfigError("the object database is open for reading only; open it for writing")
        with transaction(db):
            yield db

    def _row(self, stone_id: int) -> sqlite3.Row:
        row = (
            self._connection().execute("SELECT * FROM stones WHERE id = ?", (stone_id,)).fetchone()
        )
        if row is None:
            known = [
                str(r["id"])
                for r in self._connection().execute("SELECT id FROM stones ORDER BY id")
            ]
            raise DataError(
                f"no stone {stone_id} in the object database; there is {', '.join(known) or 'none'}"
            )
        return row  # type: ignore[no-any-return]

    def _add(
        self, db: sqlite3.Connection, segment: Segment, stamp_s: float, seen_from_above: bool
    ) -> int:
        settings = self._settings
        points = segment.points - segment.centroid
        surface = pack(merged(points[:0], points, settings.voxel_m, settings.max_points))
        cursor = db.execute(
            "INSERT INTO stones (state, seen_from_above, points_object, T_map_object) "
            "VALUES (?, ?, ?, ?)",
            (
                StoneState.ON_GROUND,
                seen_from_above,
                surface,
                pack_pose(pose(None, segment.centroid)),
            ),
        )
        stone_id = int(cursor.lastrowid or 0)
        self._note(db, stone_id, stamp_s, "found", StoneState.ON_GROUND, _sensors(seen_from_above))
        return stone_id

    def _reach_m(self, stone: Stone) -> float:
        """Return how far a stone may be from its stored position [m]."""
        s = self._settings
        if stone.state is StoneState.LOST:
            return s.max_roll_m + carried_m(self.history(stone.id))
        newest = next(one for one in reversed(self.history(stone.id)) if one.kind != "state")
        was_released = stone.state is StoneState.ON_GROUND and newest.kind == "release"
        return s.max_roll_m if was_released else s.max_distance_m

    def _update(
        self,
        db: sqlite3.Connection,
        stone: Stone,
        segment: Segment,
        stamp_s: float,
        seen_from_above: bool,
    ) -> int:
        known, seen, T = stone.points_map, segment.points, stone.T_map_object
        kind, fit, state = "seen", self._fit(known, seen), _found(stone.state)
        if not self._agrees(fit):
            shift, there = self._moved(known, seen)
            is_whole = self._agrees(there)
            kind, fit = ("moved", there) if is_whole else ("replaced", fit)
            known, T = (known + shift if is_whole else known[:0]), pose(T[:3, :3], T[:3, 3] + shift)
        limit = (
            self._settings.max_growth_whole if stone.seen_from_above else self._settings.max_growth
        )
        note = f"{_sensors(seen_from_above)}, {fit}"
        if kind != "replaced" and fit.growth > limit:
            self._note(db, stone.id, stamp_s, "seen", state, f"{note}: too much, nothing added")
        else:
            from_above = seen_from_above or (kind != "replaced" and stone.seen_from_above)
            self._resurface(db, stone.id, known, seen, T, from_above)
            self._note(db, stone.id, stamp_s, kind, state, note)
        return stone.id

    def _moved(self, known: Float, seen: Float) -> tuple[Float, Fit]:
        """Return the shift of a stone that moved without turning, shape (3,) [m], and its fit.

        The shift is estimated by means, by boxes and by ICP; the best fit counts, or the means if
        none fits.
        """
        by_mean, by_box = shifts_of(known, seen, self._settings.voxel_m)
        by_icp = icp_shift(known, seen, self._settings.agreement_m)
        fits = [(shift, self._fit(known + shift, seen)) for shift in (by_mean, by_box, by_icp)]
        shift, fit = max(fits, key=lambda one: (self._agrees(one[1]), -one[1].rmse_m))
        return (shift, fit) if self._agrees(fit) else fits[0]

    def _fit(self, known: Float, seen: Float) -> Fit:
        return fit_of(known, seen, self._settings.agreement_m)

    def _agrees(self, fit: Fit) -> bool:
        return fit.share >= self._settings.min_agreement and fit.rmse_m <= self._settings.max_rmse_m

    def _resurface(
        self,
        db: sqlite3.Connection,
        stone_id: int,
        known: Float,
        seen: Float,
        T: Float,
        from_above: bool,
    ) -> None:
        """Merge two surfaces, given in the map, in the frame of the object."""
        T_object_map = inverse(T)
        points = merged(
            transform(T_object_map, known),
            transform(T_object_map, seen),
            self._settings.voxel_m,
            self._settings.max_points,
        )
        db.execute(
            "UPDATE stones SET points_object = ?, seen_from_above = ?, T_map_object = "
            "? WHERE id = ?",
            (pack(points), from_above, pack_pose(T), stone_id),
        )

    def _move(self, db: sqlite3.Connection, row: sqlite3.Row, T_map_map: Float) -> None:
        T = T_map_map @ unpack_pose(row["T_map_object"])
        db.execute("UPDATE stones SET T_map_object = ? WHERE id = ?", (pack_pose(T), row["id"]))

    def _note(
        self,
        db: sqlite3.Connection,
        stone_id: int,
        stamp_s: float,
        kind: str,
        state: StoneState,
        note: str = "",
    ) -> None:
        db.execute("UPDATE stones SET state = ? WHERE id = ?", (state, stone_id))
        db.execute(
            "INSERT INTO events (stone_id, stamp_s, kind, state, T_map_object, note) "
            "SELECT id, ?, ?, ?, T_map_object, ? FROM stones WHERE id = ?",
            (stamp_s, kind, state, note, stone_id),
        )


def _found(state: StoneState) -> StoneState:
    return StoneState.ON_GROUND if state is StoneState.LOST else state


def _sensors(seen_from_above: bool) -> str:
    return "lidar and drone" if seen_from_above else "lidar"
