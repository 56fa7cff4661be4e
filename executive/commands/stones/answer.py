"""What is told of the stones of a run: to machines, and to people."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from executive.geometry.rotation import yaw_of
from executive.messages.stone import Stone
from executive.messages.stone_event import StoneEvent


def object_answer(stone: Stone, history: Sequence[StoneEvent]) -> dict[str, Any]:
    """Return a stone and its history as plain values; all in the map, SI units."""
    return {
        "id": stone.id,
        "state": stone.state.value,
        "points": len(stone.points_map),
        "centroid": stone.centroid_map.tolist(),
        "extents": np.ptp(stone.points_map, axis=0).tolist(),
        "T_map_object": stone.T_map_object.tolist(),
        "seen_from_above": stone.seen_from_above,
        "history": [
            {
                "stamp_s": event.stamp_s,
                "kind": event.kind,
                "state": event.state.value,
                "T_map_object": event.T_map_object.tolist(),
                "note": event.note,
            }
            for event in history
        ],
    }


def table(known: Sequence[tuple[Stone, Sequence[StoneEvent]]]) -> str:
    """Return a line a stone: where it is, how large, and what happened last."""
    lines = [
        "id  state       x_m     y_m     z_m  yaw_deg  points  seen by          moved  last change"
    ]
    for stone, history in known:
        x, y, z = stone.centroid_map
        yaw_deg = np.degrees(yaw_of(stone.T_map_object[:3, :3]))
        eyes = "lidar and drone" if stone.seen_from_above else "lidar"
        moved = sum(event.kind == "release" for event in history)
        last = history[-1]
        lines.append(
            f"{stone.id:2}  {stone.state.value:9} {x:7.2f} {y:7.2f} {z:7.2f} {yaw_deg:8.1f}"
            f" {len(stone.points_map):7}  {eyes:15} {moved:6}  {last.kind} at {last.stamp_s:.1f} s"
        )
    return "\n".join(lines) if known else "no stone is known"
