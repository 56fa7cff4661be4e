"""Fetch the map that a drone made of the site."""

from typing import Any

from executive.leaf.action import Action, Steps
from executive.leaf.outcome import failed, succeeded
from executive.leaf.port import Port
from executive.messages.cloud import Cloud


class SurveySite(Action):
    """Get a cloud of the site in a frame of its own (Mascaro 2020, Sec. 4.1)."""

    needs = ("surveying",)
    outputs = {"survey": Port(Cloud, "the site in the survey's own frame")}

    def run(self, **inputs: Any) -> Steps:
        cloud = yield self.context.job("surveying", "survey", self.context.rng())
        if not len(cloud):
            return failed("the survey holds no points")
        self.context.note("surveyed", points=len(cloud))
        self.context.show("survey", cloud)
        return succeeded(survey=cloud)
