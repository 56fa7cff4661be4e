"""The shipped judge: drift, tilt, a push, and the balance of forces by a linear program.

It rebuilds the structure from the poses of its stones in a world with another time step, friction
and shape of stones than the planner's and the trial site's. The linear program is the second
opinion: it knows contacts and weights, and no simulated time.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from executive_plugins.physics.equilibrium import largest_load
from executive_plugins.physics.stone_world import StoneWorld, WorldRules, world_of
from executive_plugins.physics.trial import touches_of

from executive.arrays import Float
from executive.interfaces.trial_site import StructureJudge
from executive.messages.building import AsBuilt, StandingStone

_RULES = WorldRules(step_s=0.0025, friction=0.7, pieces=24)
_SLIPPERY = WorldRules(step_s=0.0025, friction=0.5, pieces=24)
_DRIFT_S = 20.0
# Stones are in one course within this; a joint is covered this far to each side [m].
_LEVEL_M, _COVER_M = 0.3, 0.1
_GRAVITY = 9.81
_MOVED_M = 0.10  # a stone that moved this far has left its place
_TILT_STEP_DEG, _TILT_MOST_DEG, _TILT_STEP_S = 1.0, 20.0, 0.5
_PUSH_G, _PUSH_S, _AFTER_S = 0.2, 0.3, 2.0


class RigidJudge(StructureJudge):
    """Judges by simulation at friction 0.7 and 0.5, and by a linear program."""

    def judge(self, built: AsBuilt) -> Mapping[str, Any]:
        """Return the figures of a structure."""
        shape = _shape(built)
        if not built.standing:
            return {"stones": 0, **shape}
        heading = built.structure.heading_rad(built.structure.length_m / 2)
        along = np.array([np.cos(heading), np.sin(heading), 0.0])
        across = np.array([-along[1], along[0], 0.0])
        return {
            "stones": len(built.standing),
            **shape,
            "drift_20s_m": _drift_m(built),
            "tilt_across_deg": _tilt_deg(built, across, _RULES),
            "tilt_along_deg": _tilt_deg(built, along, _RULES),
            "tilt_across_slippery_deg": _tilt_deg(built, across, _SLIPPERY),
            "pushed_m": _pushed_m(built, across),
            "load_across_lp": _load(built, across),
            "load_along_lp": _load(built, along),
        }


def _shape(built: AsBuilt) -> dict[str, Any]:
    """Return height, fill of the envelope, and the share of joints that run through two courses."""
    volume = built.structure.volume_m3()
    if not built.standing:
        return {"height_m": 0.0, "fill": 0.0, "running_joints": None}
    points = np.vstack([one.vertices_map() for one in built.standing])
    return {
        "height_m": float(built.above_ground_m(points).max()),
        "fill": _inside_m3(built) / volume,
        "running_joints": _running_joints(built),
    }


def _inside_m3(built: AsBuilt) -> float:
    """Return the volume of stone within the envelope: each counts by its share of vertices."""
    total = 0.0
    for one in built.standing:
        points = one.vertices_map()
        is_in = built.structure.holds(points[:, :2], built.above_ground_m(points))
        total += one.stone.volume_m3 * float(is_in.mean())
    return total


def _running_joints(built: AsBuilt) -> float | None:
    """Return the share of joints that go on through the course above.

    A joint is the gap between two stones that are beside one another along the structure. It is
    covered if a higher stone lies over it with 10 cm to each side; joints with nothing above are
    not counted.
    """
    spans = [_span(built, one) for one in built.standing]
    running = counted = 0
    for begin, end, z in spans:
        for other in spans:
            is_beside = abs(other[2] - z) < _LEVEL_M and abs(other[0] - end) < _LEVEL_M
            if not is_beside or other[0] <= begin:
                continue
            joint = (end + other[0]) / 2
            above = [s for s in spans if s[2] > z + _LEVEL_M and _meets(s, joint)]
            counted += bool(above)
            covers = (s[0] < joint - _COVER_M and s[1] > joint + _COVER_M for s in above)
            running += bool(above) and not any(covers)
    return running / counted if counted else None


def _span(built: AsBuilt, one: StandingStone) -> tuple[float, float, float]:
    """Return where a stone begins and ends along the structure, and its height [m]."""
    along = built.structure.along_across(one.vertices_map()[:, :2])[0]
    return float(along.min()), float(along.max()), float(one.T_map_stone[2, 3])


def _meets(span: tuple[float, float, float], joint_m: float) -> bool:
    return span[0] < joint_m + _COVER_M and span[1] > joint_m - _COVER_M


def _places(world: StoneWorld) -> Float:
    return np.array([world.pose_of(number)[:3, 3] for number in world.free])


def _rested(built: AsBuilt, rules: WorldRules) -> StoneWorld:
    """Return the structure in this judge's world, after its own stones have found their rest."""
    world = world_of(built, rules)
    world.settle(0.5, 2.0)
    return world


def _drift_m(built: AsBuilt) -> float:
    """Return how far any stone moves in 20 s, from the poses that were handed in."""
    world = world_of(built, _RULES)
    before = _places(world)
    world.step(round(_DRIFT_S / _RULES.step_s))
    return float(np.linalg.norm(_places(world) - before, axis=1).max())


def _tilt_deg(built: AsBuilt, towards: Float, rules: WorldRules) -> float:
    """Return the tilt to the worse of two sides at which a stone has moved by 10 cm [deg]."""
    return min(_tilt_one_side(built, sign * towards, rules) for sign in (1.0, -1.0))


def _tilt_one_side(built: AsBuilt, towards: Float, rules: WorldRules) -> float:
    world = _rested(built, rules)
    before = _places(world)
    for degrees in np.arange(_TILT_STEP_DEG, _TILT_MOST_DEG + 1e-9, _TILT_STEP_DEG):
        angle = np.radians(degrees)
        down = np.array([0.0, 0.0, -np.cos(angle)])
        world.model.opt.gravity[:] = _GRAVITY * (down + np.sin(angle) * towards)
        world.step(round(_TILT_STEP_S / rules.step_s))
        if np.linalg.norm(_places(world) - before, axis=1).max() > _MOVED_M:
            return float(degrees - _TILT_STEP_DEG)
    return _TILT_MOST_DEG


def _pushed_m(built: AsBuilt, towards: Float) -> float:
    """Return how far a top stone moves by 0.2 g for 0.3 s across the structure [m]."""
    world = _rested(built, _RULES)
    before = _places(world)
    is_top = before[:, 2] >= np.quantile(before[:, 2], 0.75)
    first = world.model.body("stone_0").id
    for number in np.flatnonzero(is_top):
        mass = built.standing[number].stone.mass_kg
        world.data.xfrc_applied[first + number, :3] = _PUSH_G * _GRAVITY * mass * towards
    world.step(round(_PUSH_S / _RULES.step_s))
    world.data.xfrc_applied[:] = 0.0
    world.step(round(_AFTER_S / _RULES.step_s))
    moved = np.linalg.norm(_places(world) - before, axis=1)
    return float(moved[is_top].max())


def _load(built: AsBuilt, towards: Float) -> float | None:
    """Return the horizontal load that the whole bears by the linear program, over its weight."""
    world = _rested(built, _RULES)
    masses = np.array([one.stone.mass_kg for one in built.standing])
    touches = touches_of(world)
    sides = (sign * towards for sign in (1.0, -1.0))
    found = [largest_load(touches, _places(world), masses, _RULES.friction, side) for side in sides]
    known = [one for one in found if one is not None]
    return min(known) if len(known) == len(found) else None
