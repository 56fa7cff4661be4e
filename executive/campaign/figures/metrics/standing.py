"""Metrics of what really stands of a structure: by the true poses, and by a judge of them."""

import math
from collections.abc import Sequence
from typing import ClassVar

from executive.interfaces.metric import Metric, RunRecord, Values
from executive.interfaces.truth import TrueStructure

_JUDGED = (
    " The judge (`loop.structure_judge`) rebuilds the structure from the true poses in another"
    " world than that of the mission."
)


class StonesStanding(Metric):
    """Stones that really stand in a structure."""

    title = "stones over the foot of a structure"
    description = (
        "Number of stones whose middles are over the foot of a structure at the end, by the"
        " simulator's truth, whatever the mission knows of them."
    )

    def measure(self, run: RunRecord) -> Values | None:
        found = _structures(run)
        return Values(tuple(float(len(one.stones)) for one in found)) if found else None


class StandingMoved(Metric):
    """How far stones of a structure moved after they were placed."""

    title = "stones of a structure moved by later ones"
    unit = "m"
    is_more_better = False
    description = (
        "Distance of each stone that stands in a structure at the end from where it was when the"
        " newest attempt at it had ended, by the simulator's truth."
    )

    def measure(self, run: RunRecord) -> Values | None:
        found = _structures(run)
        return Values(tuple(moved for one in found for moved in one.moved_m)) if found else None


class _Judged(Metric):
    """A figure of the judge's verdict on each structure.

    Attributes:
        key: The figure's name in the verdict.
        scale: What turns the judge's figure into the metric's unit.
    """

    key: ClassVar[str]
    scale: ClassVar[float] = 1.0

    def measure(self, run: RunRecord) -> Values | None:
        verdicts = [one.verdict for one in _structures(run) if one.verdict]
        known = [value for one in verdicts if (value := one.get(self.key)) is not None]
        return Values(tuple(self.scale * value for value in known)) if verdicts else None


class StandingFill(_Judged):
    """Share of the envelope that stones fill."""

    title = "fill of the envelope of a structure"
    description = (
        "Volume of the stones within the envelope of a structure over the envelope's; a stone is as"
        " large as the shape by which it touches." + _JUDGED
    )
    key = "fill"


class StandingJoints(_Judged):
    """Share of joints that run through two courses."""

    title = "running joints of a structure"
    is_more_better = False
    description = (
        "Share of the joints between neighbouring stones, of those with a stone above, that no"
        " stone above covers by 0.10 m to each side." + _JUDGED
    )
    key = "running_joints"


class StandingDrift(_Judged):
    """How far stones creep by themselves."""

    title = "drift of a structure in 20 s"
    unit = "m"
    is_more_better = False
    description = (
        "Largest distance of a stone of a structure, 20 s later, from its pose at the end."
        + _JUDGED
    )
    key = "drift_20s_m"


class StandingPushed(_Judged):
    """How far a push moves the top stones."""

    title = "motion of the top stones of a structure by a push"
    unit = "m"
    is_more_better = False
    description = (
        "Largest distance by which a horizontal load of 0.2 of their weights for 0.3 s, across the"
        " structure, moves a stone of its top quarter." + _JUDGED
    )
    key = "pushed_m"


class _Tilted(_Judged):
    """Tilt of the whole at which no stone has left its place yet."""

    unit = "rad"
    scale = math.radians(1.0)


class StandingTiltAcross(_Tilted):
    """Tilt across the structure that it withstands."""

    title = "tilt across that a structure withstands"
    description = (
        "Tilt of the ground across the structure, to the worse side and 20° at most, at which no"
        " stone has moved by 0.10 m." + _JUDGED
    )
    key = "tilt_across_deg"


class StandingTiltAlong(_Tilted):
    """Tilt along the structure that it withstands."""

    title = "tilt along that a structure withstands"
    description = (
        "Tilt of the ground along the structure, to the worse side and 20° at most, at which no"
        " stone has moved by 0.10 m." + _JUDGED
    )
    key = "tilt_along_deg"


class StandingTiltSlippery(_Tilted):
    """Tilt across the structure that it withstands with less friction."""

    title = "tilt across that a structure withstands with friction 0.5"
    description = "As `standing_tilt_across_rad`, with a friction of 0.5 in place of 0.7." + _JUDGED
    key = "tilt_across_slippery_deg"


def _structures(run: RunRecord) -> Sequence[TrueStructure]:
    truth = run.report.truth
    return () if truth is None else truth.structures
