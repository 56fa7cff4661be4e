"""Metrics of the object database, against the simulator's truth."""

from abc import abstractmethod
from collections.abc import Sequence

from executive.campaign.figures.metrics.report import stones
from executive.interfaces.metric import Metric, RunRecord, Share, Values
from executive.interfaces.truth import Realignment, TrueStone

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
    """An error of each stone of the truth."""

    is_more_better = False

    @abstractmethod
    def error(self, stone: TrueStone) -> float | None:
        """Return the error of a stone; None of one that is not in the database."""

    def measure(self, run: RunRecord) -> Values | None:
        found = [self.error(one) for one in stones(run)]
        return Values(tuple(error for error in found if error is not None)) if found else None


class DatabaseError(_OfStones):
    """Distance of each tracked pose from the true one."""

    title = "position error of tracked stones"
    unit = "m"
    description = "Distance" + _DATABASE

    def error(self, stone: TrueStone) -> float | None:
        return stone.database_error_m


class DatabaseRotationError(_OfStones):
    """Angle of each tracked pose from the true one."""

    title = "rotation error of tracked stones"
    unit = "rad"
    description = "Angle" + _DATABASE

    def error(self, stone: TrueStone) -> float | None:
        return stone.database_error_rad


class _OfReleases(Metric):
    """An error of each release of the truth."""

    is_more_better = False
    is_only_realigned = True

    @abstractmethod
    def error(self, release: Realignment) -> float:
        """Return the error of a release."""

    def measure(self, run: RunRecord) -> Values | None:
        found = _releases(run)
        if found is None:
            return None
        counted = (one for one in found if one.was_realigned or not self.is_only_realigned)
        return Values(tuple(self.error(one) for one in counted))


class RealignmentError(_OfReleases):
    """Distance of each re-aligned pose from the true one."""

    title = "position error after re-alignment"
    unit = "m"
    description = "Distance" + _REALIGNED

    def error(self, release: Realignment) -> float:
        return release.error_m


class RealignmentRotationError(_OfReleases):
    """Angle of each re-aligned pose from the true one."""

    title = "rotation error after re-alignment"
    unit = "rad"
    description = "Angle" + _REALIGNED

    def error(self, release: Realignment) -> float:
        return release.error_rad


class SettledError(_OfReleases):
    """Distance of each pose after the release from the true one."""

    title = "position error before re-alignment"
    unit = "m"
    is_only_realigned = False
    description = "Distance" + _SETTLED

    def error(self, release: Realignment) -> float:
        return release.settled_error_m


class SettledRotationError(_OfReleases):
    """Angle of each pose after the release from the true one."""

    title = "rotation error before re-alignment"
    unit = "rad"
    is_only_realigned = False
    description = "Angle" + _SETTLED

    def error(self, release: Realignment) -> float:
        return release.settled_error_rad


class Realigned(Metric):
    """Releases that were followed by a re-alignment."""

    title = "releases that were re-aligned"
    is_share = True
    description = (
        "Releases of known stones whose pose was then corrected on the new map, out of all releases"
        " of known stones."
    )

    def measure(self, run: RunRecord) -> Share | None:
        found = _releases(run)
        if found is None:
            return None
        return Share(sum(one.was_realigned for one in found), len(found))


class StonesKnown(Metric):
    """Stones of the site that the database knows."""

    title = "stones known"
    is_share = True
    description = (
        "Stones of the site that are in the object database, out of all stones of the site, by the"
        " simulator's truth about where each object was found."
    )

    def measure(self, run: RunRecord) -> Share | None:
        truth = run.report.truth
        if truth is None or not truth.objects:
            return None
        return Share(truth.objects.known, truth.objects.stones)


class Ghosts(Metric):
    """Objects of the database that are no stone of their own."""

    title = "objects that are no stone, or a stone known twice"
    is_more_better = False
    description = (
        "Number of objects in the database at the end that were found where no stone was, or that"
        " are a stone which another object stands for already."
    )

    def measure(self, run: RunRecord) -> Values | None:
        truth = run.report.truth
        if truth is None or not truth.objects:
            return None
        return Values((truth.objects.ghosts + truth.objects.twice,))


def _releases(run: RunRecord) -> Sequence[Realignment] | None:
    truth = run.report.truth
    return None if truth is None else truth.realignments
