"""What a view of the map writes into the database: known stones, pieces of them, and new ones."""

import sqlite3
from collections.abc import Sequence
from dataclasses import dataclass

from executive_plugins.objects.association import PIECE, owner_of_piece
from executive_plugins.objects.growth import merged
from executive_plugins.objects.rows import add_event, forget_grasps
from executive_plugins.objects.schema import pack_pose
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.sighting import sighting_of
from executive_plugins.objects.surface import pack

from executive.geometry.pose import pose
from executive.messages.segment import Segment
from executive.messages.stone import Stone, StoneState


@dataclass(frozen=True, slots=True)
class View:
    """A view that is written into the database.

    Attributes:
        db: The connection, within a transaction.
        stamp_s: Time of the view [s].
        seen_from_above: Whether a drone's survey is part of it.
        settings: Those of the database.
    """

    db: sqlite3.Connection
    stamp_s: float
    seen_from_above: bool
    settings: SqliteObjectsSettings

    def update(self, stone: Stone, segment: Segment) -> None:
        """Write what a segment says of the stone that it is."""
        sighting = sighting_of(stone, segment, self.settings)
        state = StoneState.ON_GROUND if stone.state is StoneState.LOST else stone.state
        told = f"{self._sensors}, {sighting.fit}"
        if sighting.is_too_large:
            self._add_event(stone.id, "seen", state, f"{told}: too much, nothing added")
            return
        if sighting.kind == "replaced":
            forget_grasps(self.db, stone.id)  # how the surface lies in the object's frame is new
        was_from_above = sighting.kind != "replaced" and stone.seen_from_above
        self.db.execute(
            "UPDATE stones SET points_object = ?, seen_from_above = ?, T_map_object = ? "
            "WHERE id = ?",
            (
                pack(sighting.points_object),
                self.seen_from_above or was_from_above,
                pack_pose(sighting.T_map_object),
                stone.id,
            ),
        )
        self._add_event(stone.id, sighting.kind, state, told)

    def piece_or_new(self, segment: Segment, lying: Sequence[Stone]) -> int:
        """Note a piece of a known stone, or add a new stone; return its id."""
        owner = owner_of_piece(segment, lying, self.settings.explained_m)
        if owner is None:
            return self._add(segment)
        told = f"{self._sensors}, {len(segment.points)} points in its body"
        self._add_event(owner.id, PIECE, owner.state, told)
        return owner.id

    def _add(self, segment: Segment) -> int:
        s, points = self.settings, segment.points - segment.centroid
        surface = pack(merged(points[:0], points, s.voxel_m, s.max_points))
        cursor = self.db.execute(
            "INSERT INTO stones (state, seen_from_above, points_object, T_map_object) "
            "VALUES (?, ?, ?, ?)",
            (
                StoneState.ON_GROUND,
                self.seen_from_above,
                surface,
                pack_pose(pose(None, segment.centroid)),
            ),
        )
        stone_id = int(cursor.lastrowid or 0)
        self._add_event(stone_id, "found", StoneState.ON_GROUND, self._sensors)
        return stone_id

    def _add_event(self, stone_id: int, kind: str, state: StoneState, note: str) -> None:
        add_event(self.db, stone_id, self.stamp_s, kind, state, note)

    @property
    def _sensors(self) -> str:
        return "lidar and drone" if self.seen_from_above else "lidar"
