"""Lay the drone's map over the lidar map."""

from typing import Any

from executive.leaf.action import Action, Steps
from executive.leaf.outcome import failed, succeeded
from executive.leaf.port import Port
from executive.messages.alignment import Alignment
from executive.messages.cloud import Cloud


class RegisterDroneMap(Action):
    """Register the survey on segments (Mascaro 2020, Sec. 4.4); fails when the gate refuses."""

    needs = ("mapping", "registration")
    inputs = {"survey": Port(Cloud, "the site in the survey's own frame")}
    outputs = {
        "alignment": Port(Alignment, "how the survey lies in the map"),
        "drone_map": Port(Cloud, "the survey expressed in the map"),
    }

    def run(self, **inputs: Any) -> Steps:
        survey: Cloud = inputs["survey"]
        target = self.context.plugin("mapping").cloud()
        if not len(target):
            return failed("the map is empty: scan first")
        alignment = yield self.context.job(
            "registration", "register", target, survey, self.context.rng()
        )
        self.context.note(
            "registration",
            accepted=alignment.accepted,
            reason=alignment.reason,
            rmse_m=alignment.rmse_m,
            overlap=alignment.overlap,
            scale=alignment.scale,
            matched_segments=len(alignment.matched_segments),
            T_map_survey=alignment.T_target_source,
        )
        if not alignment.accepted:
            return failed(f"registration refused: {alignment.reason}")
        drone_map = Cloud("map", alignment.apply(survey.points))
        self.context.show("drone_map", drone_map)
        return succeeded(
            f"rmse {1e3 * alignment.rmse_m:.0f} mm", alignment=alignment, drone_map=drone_map
        )
