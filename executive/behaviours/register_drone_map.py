"""Register the drone's map on the lidar map."""

from dataclasses import dataclass

from executive.events.site import SurveyRegistered
from executive.interfaces.mapping import Mapper
from executive.interfaces.registration import Registrar
from executive.leaf.action import Action, Steps
from executive.leaf.memory import OnResume
from executive.leaf.outcome import failed, succeeded
from executive.leaf.surroundings import map_cloud
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud


@dataclass(frozen=True, slots=True)
class DroneMap:
    """The survey in the map's frame.

    Attributes:
        alignment: Transform of the survey into the map, with its figures.
        drone_map: The survey expressed in the frame `map`.
    """

    alignment: Alignment
    drone_map: Cloud


class RegisterDroneMap(Action):
    """Register the survey on segments; fail when the registration's own test refuses it.

    Source: Mascaro et al. 2020, Sec. 4.4.
    """

    needs = (Mapper, Registrar)
    on_resume = OnResume.REDO

    def run(self, survey: Cloud) -> Steps[DroneMap]:
        """Register the survey on the map as it is now.

        Args:
            survey: The site in the survey's own frame.
        """
        target = yield from map_cloud(self.context)
        if not len(target):
            return failed("the map is empty: scan first")
        alignment = yield from self.context.job(
            self.context.use(Registrar).register, target, survey, self.context.rng()
        )
        self.context.record(
            SurveyRegistered(
                accepted=alignment.accepted,
                reason=alignment.reason,
                rmse_m=alignment.rmse_m,
                overlap=alignment.overlap,
                scale=alignment.scale,
                matched_segments=len(alignment.matched_segments),
                T_map_survey=alignment.T_target_source,
            )
        )
        if not alignment.accepted:
            reason = f"registration refused: {alignment.reason}"
            return failed(reason, is_final=alignment.is_final)
        drone_map = Cloud("map", alignment.apply(survey.points))
        self.context.show("drone_map", drone_map)
        return succeeded(DroneMap(alignment, drone_map), f"rmse {1e3 * alignment.rmse_m:.0f} mm")
