"""Lower a held stone until the ground carries it."""

from collections import deque
from collections.abc import Callable, Generator
from typing import Any

import numpy as np
from pydantic import Field

from executive.config import Meters, Seconds, Settings
from executive.events.stone import StoneTouchedDown
from executive.interfaces.mapping import Mapper
from executive.interfaces.monitoring import Monitor
from executive.interfaces.motion import MotionPlanner
from executive.interfaces.objects import ObjectDatabase
from executive.interfaces.robot import Robot
from executive.leaf.action import Action, Steps
from executive.leaf.claims import Part
from executive.leaf.follow import follow
from executive.leaf.memory import OnResume
from executive.leaf.outcome import Outcome, failed, succeeded
from executive.leaf.raise_gripper import raise_gripper
from executive.leaf.rest import come_to_rest
from executive.leaf.steady_line import steady_line
from executive.leaf.surroundings import surroundings
from executive.leaf.tool_way import tool_way
from executive.leaf.watched import watched
from executive.leaf.weighing import hanging
from executive.messages.hold import Hold
from executive.messages.placement import Placement
from executive.messages.request import MotionPlan, MoveRequest
from executive.messages.trajectory import JointTrajectory

_OFF_M = 0.05  # by which a stone is raised at least off what it has met


class LowerUntilDownSettings(Settings):
    step: Meters = Field(
        0.02,
        gt=0,
        le=0.2,
        description="Way down within the time of a weighing [m]: the stone is pressed onto the "
        "ground by little more than this, and falls by no more.",
    )
    below: Meters = Field(
        0.2,
        ge=0,
        le=1,
        description="How far below the planned place the ground is sought [m].",
    )
    stands: float = Field(
        0.5,
        gt=0,
        lt=1,
        description="Share of the stone's weight of which less hangs in the jaws once the ground "
        "carries it. By 0.5 a long stone that has met something with one end is lowered on, and "
        "turns in the jaws.",
    )
    early: Meters | None = Field(
        None,
        ge=0,
        le=1,
        description="Height above the planned release from which a stone that is carried has met "
        "something else than its place, and this fails [m]; by default it stands at any height.",
    )
    window: Seconds = Field(
        0.4, gt=0, le=5, description="Time over which the weight in the jaws is averaged [s]."
    )


class LowerUntilDown(Action[LowerUntilDownSettings]):
    """Lower a stone slowly until its weight has left the jaws; fail if it never does.

    The stone is weighed on the way, at a speed of `step` in each `window`. Once its weight is off
    the jaws the arm stops, and a weighing at rest decides: a stone that still hangs is lowered
    further. It follows a motion that ends some centimetres above the placement (`above` of
    `PlanPlacement`). The ground that the map shows is some centimetres off, and so is the stone's
    underside, which nothing has seen. With `early`, a stone that is carried that far above the plan
    has met something else than its place, and this fails with the stone in the jaws. A stone whose
    weight no monitor knows is lowered to the plan, and this tells so. A stone that has slipped is
    set down so, too: heavy ones that are let go in the air swing a machine on its legs.
    """

    needs = (Robot, MotionPlanner, Mapper, ObjectDatabase, Monitor)
    claims = (Part.ARM, Part.CABIN)
    on_resume = OnResume.REDO

    def run(self, hold: Hold, placement: Placement | None = None) -> Steps[None]:
        """Weigh and lower in turn.

        Args:
            hold: Which stone is held, and how.
            placement: The placement that is carried out; without one the stone is set down where it
                is, and the ground is sought from there.
        """
        if moving := (yield from come_to_rest(self.context)):
            return failed(moving)
        began_m = planned_m = self._height_m()
        weight = self.context.weight()
        if placement is not None:
            planned_m = placement.T_map_gripper[2, 3]
        least_kg = 0.0 if weight is None else self.settings.stands * weight.mass_kg
        while True:
            left = yield from hanging(self.context, self.settings.window, least_kg)
            above_m = self._height_m() - planned_m
            if weight is None or left is None:
                lowered = yield from self._lower(hold, max(above_m, 0.0))
                told = f"no monitor weighs the stone: lowered by {above_m:.2f} m to the plan"
                return succeeded(reason=told) if lowered.success else lowered
            if left.mass_kg < least_kg:
                if placement is not None:
                    self.context.record(StoneTouchedDown(hold.stone_id, above_m, left.mass_kg))
                return (yield from self._stood(hold, above_m, began_m))
            if above_m - 0.5 * self.settings.step < -self.settings.below:
                return failed(
                    f"stone {hold.stone_id} still hangs in the jaws with {left}, "
                    f"{-above_m:.2f} m below its place: the ground was not met"
                )
            lowered = yield from self._sink(hold, above_m + self.settings.below, least_kg)
            if not lowered.success:
                return lowered

    def _stood(
        self, hold: Hold, above_m: float, began_m: float
    ) -> Generator[Any, Any, Outcome[None]]:
        """Judge a stone that is carried by how far that is above the planned release.

        One that is not at its place is raised to the height at which this began.
        """
        if self.settings.early is None or above_m <= self.settings.early:
            return succeeded(reason=f"it stands {above_m:+.2f} m from the plan's height")
        by_m = max(began_m - self._height_m(), _OFF_M)
        why = yield from raise_gripper(self.context, hold.stone_id, by_m)
        told = f", and was not raised off it: {why}" if why else ""
        return failed(
            f"stone {hold.stone_id} met something {above_m:.2f} m above the height of its "
            f"release, more than {self.settings.early:g} m: it is not at its place{told}"
        )

    def _height_m(self) -> float:
        return float(self.context.gripper()[2, 3])

    def _sink(
        self, hold: Hold, way_m: float, least_kg: float
    ) -> Generator[Any, Any, Outcome[None]]:
        """Lower the gripper by as much of a way as is free, until less hangs than a mass.

        The jaws may meet the ground before the end of the way: it is halved until it is free.
        """
        plan = yield from self._planned(hold, way_m)
        while plan.trajectory is None and way_m > self.settings.step:
            way_m = max(way_m / 2, self.settings.step)
            plan = yield from self._planned(hold, way_m)
        if plan.trajectory is None:
            return failed(f"no path down: {plan.reason}")
        motion = follow(self.context, self._slow(plan.trajectory))
        sunk = yield from watched(motion, self._hangs(least_kg))
        moving = (yield from come_to_rest(self.context)) if sunk.success else ""
        return failed(moving) if moving else sunk

    def _lower(self, hold: Hold, way_m: float) -> Generator[Any, Any, Outcome[None]]:
        """Lower the gripper, whatever it weighs."""
        if way_m <= 0:
            return succeeded()
        plan = yield from self._planned(hold, way_m)
        if plan.trajectory is None:
            return failed(f"no path down: {plan.reason}")
        return (yield from follow(self.context, plan.trajectory))

    def _hangs(self, least_kg: float) -> Callable[[], bool]:
        """Return a function that tells at each tick whether the jaws carry more than a mass.

        Its mean is over the window, or over what has passed of it; an arm that moves steadily is
        weighed as one at rest.
        """
        masses: deque[tuple[float, float]] = deque()

        def hangs() -> bool:
            now_s, mass_kg = self.context.now_s(), self.context.payload_kg()
            if mass_kg is not None:
                masses.append((now_s, mass_kg))
            while masses and now_s - masses[0][0] > self.settings.window:
                masses.popleft()
            return not masses or float(np.mean([mass for _, mass in masses])) >= least_kg

        return hangs

    def _planned(self, hold: Hold, way_m: float) -> Generator[Any, Any, MotionPlan]:
        """Plan straight down; the ground below the stone, which is sought, is no obstacle to it."""
        goal = self.context.gripper()
        goal[2, 3] -= way_m
        obstacles = yield from surroundings(self.context, hold.stone_id)
        request = MoveRequest(
            start=self.context.arm(),
            T_map_gripper=goal,
            T_map_base=self.context.state().T_map_base,
            leave_m=0.0,
            arrive_m=way_m,
            obstacles=obstacles,
            held_gripper=None,
            jaw_rad=hold.jaw_rad,
        )
        return (yield from self.context.job(self.context.use(MotionPlanner).move, request))

    def _slow(self, trajectory: JointTrajectory) -> JointTrajectory:
        """Return the way down at the speed of a step in each window."""
        passed_m = tool_way(self.context.machine(), trajectory)
        window_s = self.settings.window
        return steady_line(trajectory, passed_m, self.settings.step / window_s, window_s)
