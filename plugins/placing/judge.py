"""The shipped judge: drift, tilt, a push, and the balance of forces by a linear program.

It rebuilds the structure from the poses of its stones in a world with another time step, friction
and shape of stones than the planner's and the trial site's. The linear program is the second
opinion: it knows contacts and weights, and no simulated time.
"""

from collections.abc import Mapping

import numpy as np
from executive_plugins.physics.stone_world import WorldRules
from executive_plugins.placing.fill import fill_of
from executive_plugins.placing.stability_trials import StabilityTrials

from executive.interfaces.trial_site import StructureJudge
from executive.messages.building import AsBuilt, StandingStone

# The dent of a stone in the ground is half as wide as in the firm soil of missions, a guess there.
_DENT_M = 0.05
_RULES = WorldRules(step_s=0.0025, friction=0.7, pieces=24, dent_m=_DENT_M)
_SLIPPERY = WorldRules(step_s=0.0025, friction=0.5, pieces=24, dent_m=_DENT_M)
_DRIFT_S = 20.0
# Stones are in one course within this; a joint is covered this far to each side [m].
_LEVEL_M, _COVER_M = 0.3, 0.1
_TILT_MOST_DEG = 20.0


class RigidJudge(StructureJudge):
    """Judges by simulation at friction 0.7 and 0.5, and by a linear program."""

    def judge(self, built: AsBuilt) -> Mapping[str, object]:
        """Return the figures of a structure."""
        shape = shape_of(built)
        if not built.standing:
            return {"stones": 0, **shape}
        heading = built.structure.heading_rad(built.structure.length_m / 2)
        along = np.array([np.cos(heading), np.sin(heading), 0.0])
        across = np.array([-along[1], along[0], 0.0])
        rough, slippery = (StabilityTrials(built, rules) for rules in (_RULES, _SLIPPERY))
        return {
            "stones": len(built.standing),
            **shape,
            "drift_20s_m": rough.drift_m(_DRIFT_S),
            "tilt_across_deg": rough.tilt_deg(across, _TILT_MOST_DEG),
            "tilt_along_deg": rough.tilt_deg(along, _TILT_MOST_DEG),
            "tilt_across_slippery_deg": slippery.tilt_deg(across, _TILT_MOST_DEG),
            "pushed_m": rough.pushed_m(across),
            "load_across_lp": rough.load(across),
            "load_along_lp": rough.load(along),
        }


def shape_of(built: AsBuilt) -> dict[str, float | None]:
    """Return height, fill of the envelope, and the share of joints that run through two courses."""
    if not built.standing:
        return {"height_m": 0.0, "fill": 0.0, "fill_below_top": None, "running_joints": None}
    points = np.vstack([one.vertices_map() for one in built.standing])
    fill = fill_of(built)
    return {
        "height_m": float(built.above_ground_m(points).max()),
        "fill": fill.of_envelope,
        "fill_below_top": fill.below_top,
        "running_joints": _running_joints(built),
    }


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
