"""Metrics of the object database, against the simulator's truth."""

from executive.campaign.figures.metrics.report import stones, truth
from executive.interfaces.metric import Metric, RunRecord, Share, Values

_DATABASE = (
    " of a stone's pose in the object database at the end from where the true motion of the stone"
    " has carried it since its newest model was seen, for each stone that is in the database."
)
_REALIGNED = (
    " of a stone's pose after its re-alignment on the new map from where the true motion of the"
    " stone has carried it since it was found, for each release of a known stone that was followed"
    " by a re-alignment."
)
_SETTLED = (
    " of a stone's pose after its release, as it follows from the gripper's motion, from where the"
    " true motion of the stone has carried it, for each release of a known stone."
)


class _OfStones(Metric):
    """An error of each stone of the truth, in a field of its own."""

    is_more_better = False
    field = ""

    def measure(self, run: RunRecord) -> Values | None:
        found = [one[self.field] for one in stones(run)]
        return Values(tuple(error for error in found if error is not None)) if found else None


class DatabaseError(_OfStones):
    """Distance of each tracked pose from the true one."""

    title = "position error of tracked stones"
    unit = "m"
    field = "database_error_m"
    description = "Distance" + _DATABASE


class DatabaseRotationError(_OfStones):
    """Angle of each tracked pose from the true one."""

    title = "rotation error of tracked stones"
    unit = "rad"
    field = "database_error_rad"
    description = "Angle" + _DATABASE


class _OfReleases(Metric):
    """An error of each release of the truth, in a field of its own."""

    is_more_better = False
    field = ""
    is_only_realigned = True

    def measure(self, run: RunRecord) -> Values | None:
        found = truth(run).get("realignments")
        if found is None:
            return None
        counted = (one for one in found if one["was_realigned"] or not self.is_only_realigned)
        return Values(tuple(one[self.field] for one in counted))


class RealignmentError(_OfReleases):
    """Distance of each re-aligned pose from the true one."""

    title = "position error after re-alignment"
    unit = "m"
    field = "error_m"
    description = "Distance" + _REALIGNED


class RealignmentRotationError(_OfReleases):
    """Angle of each re-aligned pose from the true one."""

    title = "rotation error after re-alignment"
    unit = "rad"
    field = "error_rad"
    description = "Angle" + _REALIGNED


class SettledError(_OfReleases):
    """Distance of each pose after the release from the true one."""

    title = "position error before re-alignment"
    unit = "m"
    field = "settled_error_m"
    is_only_realigned = False
    description = "Distance" + _SETTLED


class SettledRotationError(_OfReleases):
    """Angle of each pose after the release from the true one."""

    title = "rotation error before re-alignment"
    unit = "rad"
    field = "settled_error_rad"
    is_only_realigned = False
    description = "Angle" + _SETTLED


class Realigned(Metric):
    """Releases that were followed by a re-alignment."""

    title = "releases that were re-aligned"
    is_share = True
    description = (
        "Releases of known stones whose pose was then corrected on the new map, out of all releases"
        " of known stones."
    )

    def measure(self, run: RunRecord) -> Share | None:
        found = truth(run).get("realignments")
        if found is None:
            return None
        return Share(sum(one["was_realigned"] for one in found), len(found))


class StonesKnown(Metric):
    """Stones of the site that the database knows."""

    title = "stones known"
    is_share = True
    description = (
        "Stones of the site that are in the object database, out of all stones of the site, by the"
        " simulator's truth about where each object was found."
    )

    def measure(self, run: RunRecord) -> Share | None:
        found = truth(run).get("objects")
        return Share(found["known"], found["stones"]) if found else None


class Ghosts(Metric):
    """Objects of the database that are no stone of their own."""

    title = "objects that are no stone, or a stone known twice"
    is_more_better = False
    description = (
        "Number of objects in the database at the end that were found where no stone was, or that"
        " are a stone which another object stands for already."
    )

    def measure(self, run: RunRecord) -> Values | None:
        found = truth(run).get("objects")
        return Values((found["ghosts"] + found["twice"],)) if found else None
