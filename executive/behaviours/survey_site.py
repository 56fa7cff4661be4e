"""Get the map that a drone made of the site."""

from dataclasses import dataclass

from executive.errors import DataError
from executive.events.site import SiteSurveyed
from executive.interfaces.surveying import Survey
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.messages.cloud import Cloud


@dataclass(frozen=True, slots=True)
class SiteSurvey:
    """A map of the site from outside.

    Attributes:
        survey: The site in the survey's own frame.
    """

    survey: Cloud


class SurveySite(Action):
    """Get a cloud of the site in a frame of its own (Mascaro et al. 2020, Sec. 4.1)."""

    needs = (Survey,)
    on_resume = OnResume.REDO

    def run(self) -> Steps[SiteSurvey]:
        try:
            cloud = yield from self.context.job(self.context.use(Survey).survey, self.context.rng())
        except DataError as error:  # there is no usable survey, as the interface allows
            return failed(str(error))
        if not len(cloud):
            return failed("the survey holds no points")
        self.context.record(SiteSurveyed(len(cloud)))
        self.context.show("survey", cloud)
        return succeeded(SiteSurvey(cloud))
