"""Whole moves on sites with stones: picks, placements, and refusals of each kind."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.motion.hermite import Hermite
from executive_plugins.motion.settings import HermiteSettings

from executive.geometry.pose import pose
from executive.messages.cloud import Cloud

# Iterations stop at a tolerance of their own.
ITERATED = 1e-6


def test_moves(recorded, machine, make_site, make_planner) -> None:
    planner, told = make_planner("m545"), []
    for seed in (1, 2):
        site = make_site(machine, (4.5, 7.0), 1.0, seed)
        pick = site.pick(machine.posture("carry"), seed)
        plan = planner.move(pick)
        told.append(plan)
        if plan.trajectory is not None:
            place = site.place(plan.trajectory.position[-1], pick.T_map_gripper, seed)
            told.append(planner.move(place))
    recorded(told, relative=ITERATED)


def test_refused_moves(recorded, machine, make_site, make_planner) -> None:
    planner, told = make_planner("m545"), []
    site = make_site(machine, (4.5, 7.0), 1.0, 3)
    pick = site.pick(machine.posture("carry"), 0)
    base, goal = pick.T_map_base, pick.T_map_gripper
    wall = np.random.default_rng(1).uniform(-1, 1, (6000, 3)) * (0.3, 3.0, 3.0)
    for request in (
        replace(pick, T_map_gripper=goal @ pose(t=np.array([1.0, 0.0, 0.0]))),
        replace(pick, T_map_gripper=pose(t=np.array([0.0, 0.0, 9.0])) @ goal),
        replace(pick, T_map_gripper=pose(goal[:3, :3], base[:3, 3] + (1.2, 0, 0.3))),
        replace(pick, arrive_m=6.0),
        replace(pick, start=machine.upper.clip(-3, 3)),
        replace(pick, obstacles=Cloud("map", wall + base[:3, 3] + (4.0, 0.0, 1.0))),
    ):
        told.append(planner.move(request))
    recorded(told, relative=ITERATED)


@pytest.mark.parametrize("angle_rad", [0.0, 1.0, 8.0])
def test_swings(recorded, machine, make_planner, angle_rad) -> None:
    planner = make_planner("m545")
    starts = machine.posture("scan"), machine.posture("carry"), machine.lower.clip(-2, 2)
    recorded([planner.swing(one, angle_rad, 8.0) for one in starts], relative=ITERATED)


def test_settings_matter(recorded, machine, make_site) -> None:
    site = make_site(machine, (4.5, 7.0), 1.0, 2)
    pick, told = site.pick(machine.posture("carry"), 2), []
    for changed in ({"speed": 0.4}, {"clearance": 1.5, "machine_clearance": 0.3}):
        planner = Hermite(HermiteSettings(**changed), machine)
        planner.start()
        told.append(planner.move(pick))
        told.append(planner.reach(np.linalg.inv(pick.T_map_base) @ pick.T_map_gripper, pick.start))
    recorded(told, relative=ITERATED)
