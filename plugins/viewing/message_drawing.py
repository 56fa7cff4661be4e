"""Messages as entities of a recording: one function per type."""

from collections.abc import Iterator, Mapping
from functools import singledispatch

import numpy as np
import rerun as rr
from executive_plugins.viewing.palette import (
    DRONE,
    ESTIMATES,
    GRASP,
    GROUND,
    PATH,
    SLOT,
    STATES,
    of_heights,
    of_number,
)
from executive_plugins.viewing.solids import mesh

from executive.machine.gripper import Gripper
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud
from executive.messages.grasp import Grasp
from executive.messages.mark import Mark
from executive.messages.placement import Slot
from executive.messages.region import Region
from executive.messages.request import MotionPlan
from executive.messages.segment import Segmentation
from executive.messages.status_change import StatusChange
from executive.messages.stone import Stone, StoneState
from executive.messages.verdict import Verdict

# Entries to log: an entity path, as text or in parts, and its components.
Drawing = Iterator[tuple[str | list[object], rr.AsComponents]]

_POINT_M = 0.015
_FRAME = "map"


@singledispatch
def draw(value: object, entity: str, gripper: Gripper, max_points: int) -> Drawing:
    """Draw one message under an entity; unknown types draw nothing."""
    yield from ()


@draw.register
def _cloud(value: Cloud, entity: str, gripper: Gripper, max_points: int) -> Drawing:
    """Draw a cloud: in the world if it is in the map, else apart, since its pose is not known."""
    points = value.points[:: 1 + len(value) // max_points]
    colours = np.array(DRONE) if "drone" in entity else of_heights(points[:, 2])
    root = "world" if value.frame == _FRAME else "survey"
    yield f"{root}/{entity}", rr.Points3D(points, colors=colours, radii=_POINT_M)


@draw.register
def _segmentation(value: Segmentation, entity: str, gripper: Gripper, max_points: int) -> Drawing:
    root = "world" if value.frame == _FRAME else "survey"
    yield f"{root}/{entity}", rr.Clear(recursive=True)
    for segment in value.segments:
        colour = of_number(segment.id)
        yield (
            f"{root}/{entity}/{segment.id}",
            rr.Points3D(segment.points, colors=colour, radii=2 * _POINT_M),
        )
    ground = value.ground.points[:: 1 + len(value.ground) // max_points]
    yield f"{root}/{entity}/ground", rr.Points3D(ground, colors=GROUND, radii=_POINT_M / 2)


@draw.register
def _stone(value: Stone, entity: str, gripper: Gripper, max_points: int) -> Drawing:
    if value.state is StoneState.LOST:
        yield f"world/{entity}", rr.Clear(recursive=True)
        return
    colour = of_number(value.id)
    points = value.points_map[:: 1 + len(value.points_map) // max_points]
    yield f"world/{entity}", rr.Points3D(points, colors=colour, radii=2 * _POINT_M)
    label = f"{value.id} {value.state.replace('_', ' ')}"
    yield (
        f"world/{entity}/name",
        rr.Points3D([value.centroid_map], colors=colour, radii=0.05, labels=[label]),
    )
    yield f"log/{entity}", rr.TextLog(f"stone {label}", color=colour)


@draw.register
def _grasp(value: Grasp, entity: str, gripper: Gripper, max_points: int) -> Drawing:
    """Draw the open gripper around the stone, and its approach."""
    opening_m = float(np.clip(value.opening_m, gripper.opening_m(0.0), gripper.max_opening_m))
    hulls = [hull for part in gripper.hulls(gripper.jaw_rad(opening_m)).values() for hull in part]
    T = value.T_map_gripper
    yield f"world/{entity}", rr.Transform3D(translation=T[:3, 3], mat3x3=T[:3, :3])
    yield f"world/{entity}/gripper", mesh(hulls, (*GRASP, 110))
    approach = rr.Arrows3D(vectors=[[1.0, 0, 0]], origins=[[-1.2, 0, 0]], colors=GRASP, radii=0.03)
    yield f"world/{entity}/approach", approach
    costs = ", ".join(f"{name} {cost:.3g}" for name, cost in value.costs.items())
    yield f"log/{entity}", rr.TextLog(f"{entity}: score {value.score:.3g}; {costs}", color=GRASP)


@draw.register
def _plan(value: MotionPlan, entity: str, gripper: Gripper, max_points: int) -> Drawing:
    if value.trajectory is None:
        yield f"world/{entity}", rr.Clear(recursive=True)
        yield f"log/{entity}", rr.TextLog(f"{entity}: no motion: {value.reason}", level="WARN")
    else:
        yield f"world/{entity}", rr.LineStrips3D([value.path_map], colors=PATH, radii=0.02)


@draw.register
def _slot(value: Slot, entity: str, gripper: Gripper, max_points: int) -> Drawing:
    label = f"slot {value.id}"
    yield (
        f"world/{entity}",
        rr.Points3D([value.position_map], colors=SLOT, radii=0.12, labels=[label]),
    )


@draw.register
def _mark(value: Mark, entity: str, gripper: Gripper, max_points: int) -> Drawing:
    yield (
        f"world/{entity}",
        rr.Points3D([value.position_map], colors=SLOT, radii=0.15, labels=[value.text]),
    )
    yield f"log/{entity}", rr.TextLog(f"marked: {value.text}", color=SLOT)


@draw.register
def _region(value: Region, entity: str, gripper: Gripper, max_points: int) -> Drawing:
    """Draw the outline at the height of the map's origin, with its name."""
    border = np.column_stack([value.corners_map, np.zeros(len(value.corners_map))])
    closed = np.vstack([border, border[:1]])
    strip = rr.LineStrips3D([closed], colors=SLOT, radii=0.03, labels=[value.name])
    yield f"world/{entity}", strip


@draw.register
def _alignment(value: Alignment, entity: str, gripper: Gripper, max_points: int) -> Drawing:
    text = f"{entity}: {'accepted' if value.accepted else 'refused'}, overlap {value.overlap:.2f}, "
    text += f"rmse {1000 * value.rmse_m:.0f} mm; {value.reason}"
    yield f"log/{entity}", rr.TextLog(text, level="INFO" if value.accepted else "WARN")


@draw.register
def _verdict(value: Verdict, entity: str, gripper: Gripper, max_points: int) -> Drawing:
    yield (
        f"log/{entity}",
        rr.TextLog(f"{value.monitor}: {value.trouble}: {value.detail}", level="ERROR"),
    )


@draw.register
def _status_change(value: StatusChange, entity: str, gripper: Gripper, max_points: int) -> Drawing:
    """Draw the status of the estimator as a lane, and log each change with its reason."""
    yield (
        f"states/{entity}",
        rr.StateConfiguration(values=list(ESTIMATES), colors=list(ESTIMATES.values())),
    )
    yield f"states/{entity}", rr.StateChange(state=value.after)
    text = f"{entity}: {value.before} → {value.after}" + (
        f": {value.reason}" if value.reason else ""
    )
    yield f"log/{entity}", rr.TextLog(text, level="INFO" if value.after == "GLOBAL" else "WARN")


def draw_tree(states: Mapping[str, object], changed: Mapping[str, object]) -> Drawing:
    """Draw the tree as a document, and lanes of the running leaves and of changed nodes."""
    lines = [
        f"{'  ' * path.count('/')}{path.rsplit('/', 1)[-1]}: {status}"
        for path, status in states.items()
    ]
    yield "tree", rr.TextDocument("\n".join(lines))
    yield "states/leaf", rr.StateChange(state=_running_leaves(states))
    for path, status in changed.items():
        # A list, since the parts of a path may contain any character.
        lane: list[object] = ["states", *path.split("/")]
        yield lane, rr.StateConfiguration(values=list(STATES), colors=list(STATES.values()))
        yield lane, rr.StateChange(state=str(status))


def _running_leaves(states: Mapping[str, object]) -> str:
    running = [path for path, status in states.items() if str(status) == "RUNNING"]
    leaves = [
        path for path in running if not any(other.startswith(f"{path}/") for other in running)
    ]
    return ", ".join(path.rsplit("/", 1)[-1].split(":")[-1] for path in leaves) or "none"
