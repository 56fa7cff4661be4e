"""The object database in one SQLite file.

Each change is one transaction, so a mission that is killed loses nothing.
"""

import sqlite3
import threading
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from functools import partial

from executive_plugins.objects.association import (
    Reach,
    associate_known_first,
    reach_of,
)
from executive_plugins.objects.database_file import open_file, transaction
from executive_plugins.objects.rows import add_event, add_grasp, move_row, row_of
from executive_plugins.objects.scene import surface_within, surroundings, unexplained
from executive_plugins.objects.schema import (
    WEIGHTS,
    pack_pose,
    read_event,
    read_stones,
    unpack_pose,
)
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.sighting import is_same_surface
from executive_plugins.objects.surface import pack
from executive_plugins.objects.view import View

from executive.arrays import Float, checked
from executive.errors import ConfigError, DataError
from executive.geometry.pose import inverse, transform
from executive.geometry.voxels import compile_voxel_means
from executive.interfaces.objects import ObjectDatabase
from executive.messages.cloud import Cloud
from executive.messages.segment import Segment
from executive.messages.stone import Stone, StoneState
from executive.messages.stone_event import StoneEvent
from executive.messages.weight import Weight


class SqliteObjects(ObjectDatabase):
    """Stones with identities, surfaces and poses (Mascaro 2020, Sec. 4.5).

    A thread beside the tick may observe, and ask for surroundings: it holds the lock while it reads
    or changes the stones, and not while it compares them. A stone that is changed meanwhile waits.
    """

    Settings = SqliteObjectsSettings
    beside_tick = ("observe", "surroundings", "unexplained")

    def __init__(self, settings: SqliteObjectsSettings) -> None:
        self._settings = settings
        self._open: sqlite3.Connection | None = None
        self._is_read_only = False
        self._lock = threading.RLock()  # the connection belongs to one thread at a time
        self._changing = threading.RLock()  # taken before the other by whoever changes stones

    def start(self) -> None:
        """Compile the inner loop, so that no segment has to wait for it."""
        compile_voxel_means()

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

        A stone of which the map shows parts comes in several segments. Those that are not its
        partner but lie in its body are pieces of it: they change nothing, and its history counts
        them.
        """
        if any(not len(segment.points) for segment in segments):
            raise DataError("a segment without points is no stone")
        with self._changing:
            return self._observe(segments, stamp_s, seen_from_above)

    def stones(self) -> tuple[Stone, ...]:
        """Return all stones, by id."""
        with (
            self._lock,
            closing(self._connection().execute("SELECT * FROM stones ORDER BY id")) as rows,
        ):
            return read_stones(self._connection(), rows)

    def stone(self, stone_id: int) -> Stone:
        """Return one stone as it is now."""
        with self._lock:
            return read_stones(self._connection(), [self._row(stone_id)])[0]

    def history(self, stone_id: int) -> tuple[StoneEvent, ...]:
        """Return the events of a stone, oldest first."""
        with self._lock:
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
            add_event(db, stone_id, stamp_s, "grasp", StoneState.HELD)
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
            move_row(db, row, T_map_map)
            add_event(db, stone_id, stamp_s, "release", state, "by the gripper's motion")
        return self.stone(stone_id)

    def realign(self, stone_id: int, T_map_map: Float, stamp_s: float, note: str = "") -> Stone:
        """Move the stone in the map; its state is kept."""
        row, T = self._row(stone_id), checked("T_map_map", T_map_map, 4, 4)
        with self._transaction() as db:
            move_row(db, row, T)
            add_event(db, stone_id, stamp_s, "realign", StoneState(row["state"]), note)
        return self.stone(stone_id)

    def reshape(self, stone_id: int, points_map: Float, stamp_s: float, note: str = "") -> Stone:
        """Store another surface, in the stone's frame, which stays where it is.

        Raises:
            DataError: If it has no points.
        """
        row, points = self._row(stone_id), checked("points_map", points_map, None, 3)
        if not len(points):
            raise DataError(f"stone {stone_id}: a surface without points is none")
        surface = transform(inverse(unpack_pose(row["T_map_object"])), points)
        with self._transaction() as db:
            db.execute(
                "UPDATE stones SET points_object = ? WHERE id = ?", (pack(surface), stone_id)
            )
            add_event(db, stone_id, stamp_s, "reshaped", StoneState(row["state"]), note)
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

    def keep_grasp(self, stone_id: int, T_object_gripper: Float, stamp_s: float) -> Stone:
        """Store a grasp that held the stone on its whole way."""
        self._row(stone_id)
        T = checked("T_object_gripper", T_object_gripper, 4, 4)
        with self._transaction() as db:
            add_grasp(db, stone_id, T, stamp_s)
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
            add_event(db, stone_id, stamp_s, "state", state)
        return self.stone(stone_id)

    def surroundings(self, map_cloud: Cloud, without: int | None = None) -> Cloud:
        """Return the map merged with the lying stones' models, one point a cell of `voxel_m`."""
        own = None if without is None else self.stone(without)
        s = self._settings
        points = surroundings(map_cloud.points, self.stones(), own, s.voxel_m, s.ground_m)
        return Cloud(map_cloud.frame, points)

    def unexplained(self, map_cloud: Cloud, stone_id: int, radius_m: float) -> Cloud:
        """Return the map around a stone without the points of other lying stones."""
        own = self.stone(stone_id)
        around = map_cloud.near(own.centroid_map, radius_m)
        s, others = self._settings, self._lying(stone_id)
        points = unexplained(around.points, others, s.explained_m, s.ground_m, own)
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
        with self._changing, self._lock, transaction(db):
            yield db

    def _row(self, stone_id: int) -> sqlite3.Row:
        with self._lock:
            return row_of(self._connection(), stone_id)

    def _observe(
        self, segments: Sequence[Segment], stamp_s: float, seen_from_above: bool
    ) -> tuple[Stone, ...]:
        known = [stone for stone in self.stones() if stone.state is not StoneState.HELD]
        s = self._settings
        reaches = [
            reach_of(stone, self.history(stone.id), s.max_distance_m, s.max_roll_m)
            for stone in known
        ]
        partners = associate_known_first(
            segments,
            known,
            reaches,
            s.max_growth,
            partial(is_same_surface, settings=s),
            Reach(s.max_roll_m, may_have_rolled=True),
        )
        with self._transaction() as db:
            view = View(db, stamp_s, seen_from_above, s)
            for row, segment in zip(partners, segments, strict=True):
                if row >= 0:
                    view.update(known[row], segment)
            lying = [one for one in self.stones() if one.state.is_lying]
            ids = [
                known[row].id if row >= 0 else view.piece_or_new(segment, lying)
                for row, segment in zip(partners, segments, strict=True)
            ]
        return tuple(self.stone(stone_id) for stone_id in ids)
