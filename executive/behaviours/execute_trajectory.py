"""Move along a planned trajectory."""

from typing import Any

from executive.leaf.action import Action, Steps
from executive.leaf.follow import follow
from executive.leaf.port import Port
from executive.messages.trajectory import JointTrajectory


class ExecuteTrajectory(Action):
    """Follow a trajectory to its end; cancelled, the machine stops along the path."""

    needs = ("robot",)
    inputs = {"trajectory": Port(JointTrajectory, "where the joints are to be, when")}

    def run(self, **inputs: Any) -> Steps:
        return (yield from follow(self.context, inputs["trajectory"]))
