"""Metrics of the state estimate, the map and the drone's map on it."""

from abc import abstractmethod

from executive.events.site import SiteSurveyed, SurveyRegistered
from executive.interfaces.metric import Metric, RunRecord, Share, Values
from executive.interfaces.truth import MapErrors, PositionErrors


class _Estimator(Metric):
    """A statistic of the error of the estimated cabin position over a run."""

    unit = "m"
    is_more_better = False

    @abstractmethod
    def statistic(self, errors: PositionErrors) -> float:
        """Return the statistic [m]."""

    def measure(self, run: RunRecord) -> Values | None:
        truth = run.report.truth
        if truth is None or not truth.estimate:
            return None
        return Values((self.statistic(truth.estimate.error_m),))


class EstimatorError(_Estimator):
    """Mean error of the estimated cabin position over a run."""

    title = "error of the estimated position, mean of a run"
    description = (
        "Distance of the estimated position of the cabin from the true one: the mean over a run,"
        " once a second from when the estimate is usable."
    )

    def statistic(self, errors: PositionErrors) -> float:
        return errors.mean


class EstimatorErrorMax(_Estimator):
    """Largest error of the estimated cabin position over a run."""

    title = "error of the estimated position, largest of a run"
    description = (
        "Distance of the estimated position of the cabin from the true one: the largest of a run,"
        " looked at once a second from when the estimate is usable."
    )

    def statistic(self, errors: PositionErrors) -> float:
        return errors.max


class _Map(Metric):
    """A statistic of the error of the map at the end of a run."""

    unit = "m"
    is_more_better = False

    @abstractmethod
    def statistic(self, errors: MapErrors) -> float | None:
        """Return the statistic [m]; None if there is none."""

    def measure(self, run: RunRecord) -> Values | None:
        truth = run.report.truth
        if truth is None or not truth.map:
            return None
        found = self.statistic(truth.map)
        return None if found is None else Values((found,))


class MapError(_Map):
    """Distance of the map from the true surface."""

    title = "distance of the map from the true surface"
    description = (
        "Distance of the points of the map at the end to the true surface of ground and stones at"
        " that time: the median over the points of a run."
    )

    def statistic(self, errors: MapErrors) -> float:
        return errors.distance_m.median


class MapBias(_Map):
    """Mean signed distance of the map from the true surface."""

    title = "bias of the map"
    description = (
        "Signed distance of the points of the map at the end from the true surface of ground and"
        " stones at that time, positive outside: the mean over the points of a run within 0.5 m."
    )

    def statistic(self, errors: MapErrors) -> float | None:
        return errors.bias_m


class MapDeviation(_Map):
    """Standard deviation of the signed distance of the map from the true surface."""

    title = "standard deviation of the map"
    description = (
        "Signed distance of the points of the map at the end from the true surface of ground and"
        " stones at that time: the standard deviation over the points of a run within 0.5 m."
    )

    def statistic(self, errors: MapErrors) -> float | None:
        return errors.std_m


class Registrations(Metric):
    """Registrations of the drone's map that were accepted."""

    title = "registrations accepted"
    is_share = True
    description = (
        "Registrations of the drone's map that their own test accepted, out of all that were tried."
        " A mission tries from its first dense map on until one is accepted, so that one refusal"
        " does no harm: see `registered`."
    )

    def measure(self, run: RunRecord) -> Share | None:
        counts = run.report.counts
        if not counts.registrations:
            return None
        return Share(counts.registrations_accepted, counts.registrations)


class Registered(Metric):
    """Runs in which the drone's map was registered."""

    title = "missions that register the drone's map"
    is_share = True
    description = (
        "Runs in which at least one registration of the drone's map was accepted, out of those that"
        " tried."
    )

    def measure(self, run: RunRecord) -> Share | None:
        counts = run.report.counts
        return Share(int(counts.registrations_accepted > 0), 1) if counts.registrations else None


class RegistrationTime(Metric):
    """When the drone's map is first registered."""

    title = "time to the first accepted registration"
    unit = "s"
    is_more_better = False
    description = (
        "Mission time from when the drone's map is there to the first registration of it that is"
        " accepted, in runs that have one."
    )

    def measure(self, run: RunRecord) -> Values | None:
        surveyed_s = [one.time_s for one in run.events if isinstance(one.event, SiteSurveyed)]
        accepted_s = [
            one.time_s
            for one in run.events
            if isinstance(one.event, SurveyRegistered) and one.event.accepted
        ]
        if not surveyed_s:
            return None
        return Values(tuple(time_s - surveyed_s[0] for time_s in accepted_s[:1]))


class RegistrationError(Metric):
    """Distance of the registered drone's map from its true place."""

    title = "error of the registration"
    unit = "m"
    is_more_better = False
    description = (
        "How far the middle of the drone's map, as the last accepted registration lays it over the"
        " map, is from where the whole fits the true surface best, in runs that have one."
    )

    def measure(self, run: RunRecord) -> Values | None:
        truth = run.report.truth
        if truth is None or not truth.registration:
            return None
        return Values((truth.registration.error_m,))
