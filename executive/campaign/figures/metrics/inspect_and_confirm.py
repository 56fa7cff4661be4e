"""Whether the examples `inspect` and `confirm` did what their names say, by the truth."""

import numpy as np

from executive.campaign.figures.metrics.report import stones
from executive.events.node import QuestionAnswered
from executive.events.stone import AttemptStarted, JawsClosedOnNothing, StoneGrasped
from executive.interfaces.metric import RunRecord

# Horizontal distance of a listed centroid from the true one: seen from one side, the mean of a
# stone's points is nearer to the machine than its centre, by a quarter of its length.
_LISTED_M = 0.5
# Volumes of which grasps are confirmed. Estimates are too small, by up to a fifth on simulated
# stones, so that a stone just above the lower limit may be taken for one below it.
_ASKED_M3 = (0.3 * 1.25, 0.6)


def is_inspected(run: RunRecord) -> bool:
    """Return whether the report lists each true stone once, and nothing else, and names a map."""
    listed = [one.centroid_map[:2] for one in run.report.stones]
    true = [one.centre_m[:2] for one in stones(run)]
    figure = run.report.figures.get("stones_found")
    if figure is None or not run.report.maps or not len(listed) == len(true) == figure.value:
        return False
    near = [{i for i, at in enumerate(listed) if np.hypot(*(at - one)) <= _LISTED_M}
            for one in true]  # fmt: skip
    return all(len(found) == 1 for found in near) and len(set.union(*near)) == len(listed)


def is_confirmed(run: RunRecord) -> bool:
    """Return whether no stone of the range was grasped without a yes to that very attempt."""
    volumes = {one.held_object: one.volume_m3 for one in stones(run)}
    may_grasp = False
    for one in run.events:
        match one.event:
            case AttemptStarted():
                volume_m3 = volumes.get(one.event.stone, 0.0)
                may_grasp = not _ASKED_M3[0] <= volume_m3 <= _ASKED_M3[1]
            case QuestionAnswered(answer=answer):
                may_grasp = answer == "grasp"
            case StoneGrasped() | JawsClosedOnNothing():
                if not may_grasp:
                    return False
    return True
