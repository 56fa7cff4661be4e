"""The stones of a run as files: a cloud each, and the history of all poses as one table."""

import csv
from collections.abc import Sequence
from pathlib import Path

from executive.clouds.ply_writer import write_ply
from executive.errors import ConfigError
from executive.geometry.rotation import quaternion_wxyz
from executive.messages.stone import Stone
from executive.messages.stone_event import StoneEvent

COLUMNS = ("stone", "stamp_s", "kind", "state", "x_m", "y_m", "z_m", "qw", "qx", "qy", "qz", "note")


def export_objects(folder: Path, known: Sequence[tuple[Stone, Sequence[StoneEvent]]]) -> None:
    """Write stone_001.ply … (surfaces in the map, at the stones' present poses) and poses.csv
    (T_map_object).

    Raises:
        ConfigError: If the folder holds anything already, or cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        is_empty = not any(folder.iterdir())
    except OSError as error:
        raise ConfigError(
            f"--export: {folder} cannot be made a folder: {error.strerror}"
        ) from error
    if not is_empty:
        raise ConfigError(
            f"--export: {folder} is not empty; name a new folder, so that no older "
            "stone stays in it"
        )
    for stone, _ in known:
        write_ply(folder / f"stone_{stone.id:03}.ply", stone.points_map, "map")
    with (folder / "poses.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        writer.writerows(_row(stone.id, event) for stone, history in known for event in history)


def _row(stone_id: int, event: StoneEvent) -> tuple[object, ...]:
    place = (f"{x:.6f}" for x in event.T_map_object[:3, 3])
    turn = (f"{q:.9f}" for q in quaternion_wxyz(event.T_map_object[:3, :3]))
    return (
        stone_id,
        f"{event.stamp_s:.3f}",
        event.kind,
        event.state.value,
        *place,
        *turn,
        event.note,
    )
