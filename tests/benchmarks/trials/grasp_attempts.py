"""Attempts to lift, carry by 90° and set down, in the mission's world with made-up views.

What replaces the mission's lidars, mapping and estimation is a made-up view of each stone and its
neighbours (half of the scenes with a drone's, noise of 1–3 cm, see
`plugins/grasping/learning/training_scene.py`) and an error of the gripper's pose by up to 2 cm and
1.5° along and about each axis. Paths are planned around the true surroundings. Arm, jaws, encoders
and monitors are the machine's own.
"""

import json
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from executive_plugins.grasping.learning.training_scene import look_at
from executive_plugins.monitoring.payload_scale import PayloadScale

from executive.arrays import Float
from executive.behaviours.trial_lift import TrialLiftSettings
from executive.clock import wall_s
from executive.errors import RobotError
from executive.geometry.pose import inverse, pose, transform
from executive.geometry.rotation import about_axis, angle_between, exp_so3
from executive.leaf.weighing import asked_of
from executive.messages.cloud import Cloud
from executive.messages.command import Follow, MoveJaws, SwitchLidars
from executive.messages.ground_below import ground_below
from executive.messages.joints import JointSample
from executive.messages.request import MoveRequest
from executive.messages.stone import Stone, StoneState
from executive.messages.verdict import Trouble, Verdict
from executive.mission.assembly import assemble
from executive.tree.load import load_mission
from trials.grasp_rows import (
    A_SITE,
    FIRST_SEED,
    RANKINGS,
    TRIES,
    World,
    is_first,
    is_success,
    read,
    scans_of,
    shapes_of,
    weights_id,
    world_of,
)
from trials.lone_stones import mesh_solid

OFF_M, OFF_RAD = 0.02, np.radians(1.5)
TURNS_DEG = (90, 100, 110, 120, 80)
LEAST_LIFT_M, FALL_M, ASTRAY_M, ALIKE_M, ALIKE_RAD = 0.4, 0.2, 0.6, 0.1, 0.25
EMPTY_RAD, LOOSE_RAD, TICK_S, NEAR_M, CELL_M, ROOM_M = 0.08, 0.2, 0.05, 4.0, 0.1, 0.02


@dataclass
class Site:
    """A laid-out site, and the plugins that a mission would use on it."""

    plugins: dict[str, Any]
    machine: Any
    now_s: float = 0.0
    jaw_rad: float = 0.0
    watched: int | None = None
    heights_m: list[float] = field(default_factory=list)
    verdicts: list[Verdict] = field(default_factory=list)
    masses_kg: list[float] = field(default_factory=list)  # in the jaws

    @cached_property
    def scale(self) -> PayloadScale:
        return PayloadScale(self.machine)

    @property
    def world(self) -> Any:
        return self.plugins["robot"].world

    def run(self, least_s: float) -> None:
        """Run for some time and until the arm is at rest; monitors see every sample. A verdict
        ends the run.
        """
        until_s = self.now_s + least_s
        while (self.now_s < until_s or self.world.is_moving) and not self.verdicts:
            self.now_s = round(self.now_s + TICK_S, 9)
            for sample in self.plugins["robot"].read(self.now_s):
                if isinstance(sample, JointSample):
                    self.jaw_rad = sample.of(self.machine.jaw.name)[0]
                    told = [monitor.update(sample) for monitor in self.plugins["monitoring"]]
                    self.verdicts += [verdict for verdict in told if verdict is not None]
                    self.masses_kg.append(self.scale.weigh(sample))
            if self.watched is not None:
                self.heights_m.append(float(self.T(self.watched)[2, 3]))

    def begin_hold(self, i: int) -> None:
        self.watched, self.heights_m = i, [float(self.T(i)[2, 3])]
        for monitor in self.plugins["monitoring"]:
            monitor.begin_hold()

    def lift_for_trial(self, stone: Stone, T_grasp: Float, others: list[int], held: Float) -> float:
        """Lift the held stone by a little as `TrialLift` does; return the mass in the jaws [kg] as
        a share of the least that a stone which hangs weighs. Monitors are told if it hangs.
        """
        trial = TrialLiftSettings()
        up = pose(t=np.array([0.0, 0.0, trial.height]))
        if not self.move(up @ T_grasp, trial.height, 0.0, others, held) or self.verdicts:
            return np.nan
        self.masses_kg = []
        self.run(trial.wait)
        share = float(np.mean(self.masses_kg)) / asked_of(stone, (), trial.borne).least_kg
        if share >= 1.0:
            T_base_map = inverse(self.world.T_world_base)
            around, T_base_gripper = self.surroundings(others).points, T_base_map @ self.gripper()
            below = ground_below(around, T_base_map, held, T_base_gripper)
            for monitor in self.plugins["monitoring"]:
                monitor.begin_carry()
                monitor.carry_over(below)
        return share

    def end_hold(self) -> list[Verdict]:
        """Return the verdicts of the monitors."""
        for monitor in self.plugins["monitoring"]:
            monitor.end_hold()
        told, self.verdicts, self.watched = self.verdicts, [], None
        return told

    def jaws(self, angle_rad: float) -> None:
        self.plugins["robot"].command(MoveJaws(angle_rad, self.machine.gripper.tip_force_n))
        self.run(3.0)

    def move(
        self,
        T: Float,
        leave_m: float,
        arrive_m: float,
        stones: list[int],
        held: Float | None = None,
    ) -> bool:
        """Move the gripper to a pose around the ground and some of the stones; return whether there
        was a path.
        """
        request = MoveRequest(
            start=self.world.arm.position(),
            T_map_gripper=T,
            T_map_base=self.world.T_world_base,
            leave_m=leave_m,
            arrive_m=arrive_m,
            obstacles=self.surroundings(stones),
            held_gripper=held,
            jaw_rad=self.jaw_rad,
        )
        plan = self.plugins["motion"].move(request)
        if plan.trajectory is None:
            return False
        try:
            self.plugins["robot"].command(Follow(plan.trajectory))
        except RobotError:  # a stone has pressed a joint of the arm beyond its limit
            return False
        self.run(plan.trajectory.duration_s + 0.5)
        return True

    def surroundings(self, stones: list[int]) -> Cloud:
        xy = np.stack(np.meshgrid(*[np.arange(-11.0, 11.0, CELL_M)] * 2), axis=-1).reshape(-1, 2)
        ground = np.column_stack([xy, self.world.site.terrain.height_at(xy)])
        return Cloud("map", np.concatenate([ground, *(self.skin(i) for i in stones)]))

    def skin(self, i: int) -> Float:
        return transform(self.T(i), self.world.site.stones[i].vertices)

    def T(self, i: int) -> Float:
        return self.world.T_world_body(self.world.site.stones[i].name)

    def gripper(self) -> Float:
        return self.world.T_world_body(self.machine.gripper_link)


def view_of(site: Site, i: int, rng: np.random.Generator) -> tuple[Stone, Cloud]:
    """Return the view of a stone, and the cloud around it with its neighbours."""
    stones, skin = site.world.site.stones, site.skin(i)
    foot = np.append(site.T(i)[:2, 3], skin[:, 2].min())
    near = [
        j
        for j in range(len(stones))
        if j != i and np.linalg.norm(site.T(j)[:2, 3] - foot[:2]) < NEAR_M
    ]
    own, *others = [mesh_solid(site.skin(j) - foot, stones[j].triangles) for j in (i, *near)]
    view = look_at(own, tuple(others), rng)
    known = view.stone + foot
    return Stone(i + 1, StoneState.ON_GROUND, known, known.mean(axis=0), np.eye(4), True), Cloud(
        "map", view.cloud + foot
    )


def attempt(site: Site, i: int, tried: list[Float], rng: np.random.Generator) -> dict[str, Any]:
    """Plan, hold, carry and set down one stone; return what came of it."""
    stone, cloud = view_of(site, i, rng)
    error = pose(exp_so3(rng.uniform(-OFF_RAD, OFF_RAD, 3)), rng.uniform(-OFF_M, OFF_M, 3))
    begun_s = wall_s()
    plan = site.plugins["grasping"].plan(stone, cloud, site.world.T_world_base, rng)
    row: dict[str, Any] = {
        "lifted": False,
        "dropped": False,
        "plan_s": round(wall_s() - begun_s, 2),
    }
    if not plan.grasps:
        return row | {"outcome": "no grasp", "reason": str(dict(plan.refused))}
    everything = list(range(len(site.world.site.stones)))
    site.jaws(site.machine.gripper.open_rad)
    for grasp in sorted(
        plan.grasps,
        key=lambda g: any(alike(inverse(site.T(i)) @ g.T_map_gripper, T) for T in tried),
    ):
        if site.move(grasp.T_map_gripper @ error, 0.5, 1.2, everything):
            tried.append(inverse(site.T(i)) @ grasp.T_map_gripper)
            costs = {name: round(cost, 3) for name, cost in grasp.costs.items()}
            return row | {"score": round(grasp.score, 3), "costs": costs} | carry(site, i, stone)
    return row | {"outcome": "no way", "reason": f"to none of {len(plan.grasps)}"}


def carry(site: Site, i: int, stone: Stone) -> dict[str, Any]:
    """Close, lift for a trial, turn by 90°, set down, let go, and compare with where the stone
    truly is. A stone that the trial does not lift is put back.
    """
    site.jaws(0.0)
    if site.jaw_rad < EMPTY_RAD:
        return {"outcome": "nothing held", "reason": f"jaws at {site.jaw_rad:.2f} rad"}
    T_grasp, jaw_rad = site.gripper(), site.jaw_rad
    site.begin_hold(i)
    others = [j for j in range(len(site.world.site.stones)) if j != i]
    held = transform(inverse(T_grasp), stone.points_map)
    share = site.lift_for_trial(stone, T_grasp, others, held)
    is_borne = not share < 1.0
    ways = places(site, i, T_grasp) if is_borne else iter(())
    T_place = next((T for T in ways if site.move(T, 1.0, 1.0, others, held)), None)
    told = site.end_hold()
    rise_m = max(site.heights_m) - site.heights_m[0]
    if not is_borne:
        site.move(T_grasp, 0.0, 0.2, others)
    elif told:
        site.plugins["robot"].stop()
        site.run(1.5)
        if T_place is not None and has_arrived(site.gripper(), T_place, told[0]):
            told = []
        else:
            site.move(T_grasp, 0.0, 0.5, others)  # down again, if there is a way
    released = site.T(i)
    site.jaws(min(jaw_rad + LOOSE_RAD, site.machine.gripper.open_rad))
    site.move(pose(t=np.array([0.0, 0.0, 1.5])) @ site.gripper(), 1.0, 0.0, [])
    fallen_m, astray_m = (
        released[2, 3] - site.T(i)[2, 3],
        np.linalg.norm((released - site.T(i))[:2, 3]),
    )
    good = T_place is not None and not told
    trouble = told[0].trouble.value if told else "no place" if is_borne else "not lifted"
    return {
        "outcome": "placed" if good else trouble,
        "reason": told[0].detail if told else "" if is_borne else f"{share:.0%} of the least",
        "lifted": bool(rise_m > LEAST_LIFT_M),
        "dropped": bool(fallen_m > FALL_M or astray_m > ASTRAY_M),
        "rise_m": round(float(rise_m), 2),
        "fallen_m": round(float(fallen_m), 2),
        "astray_m": round(float(astray_m), 2),
    }


def places(site: Site, i: int, T_grasp: Float) -> Iterator[Float]:
    """Yield poses of the gripper after turns about the machine, away from the sector where the
    stones lie.
    """
    at, up = site.T(i)[:3, 3], np.array([0.0, 0.0, 1.0])
    away = 1.0 if at[1] >= 0 else -1.0
    ground_m = site.world.site.terrain.height_at
    for turn_deg in TURNS_DEG:
        turn = pose(about_axis(up, away * np.radians(turn_deg)))
        rise_m = (
            float((ground_m((turn[:3, :3] @ at)[None, :2]) - ground_m(at[None, :2]))[0]) + ROOM_M
        )
        yield pose(t=rise_m * up) @ turn @ T_grasp


def has_arrived(T: Float, T_place: Float, told: Verdict) -> bool:
    """Return whether a stone met the ground slightly early and shifted in the jaws, which missions
    accept, too.
    """
    gap = (T - T_place)[:3, 3]
    return bool(told.trouble is Trouble.SLIP and np.hypot(gap[0], gap[1]) < 0.1 and gap[2] < 0.25)


def alike(T_a: Float, T_b: Float) -> bool:
    return bool(
        np.linalg.norm((T_a - T_b)[:3, 3]) < ALIKE_M
        and angle_between(T_a[:3, :3], T_b[:3, :3]) < ALIKE_RAD
    )


def lay_out(world: World, ranking: str, number: int, folder: Path) -> Site:
    settings = [*RANKINGS[ranking], f"robot.site.stones.count={A_SITE}"]
    # The arm carries whatever the grasp holds as far as it stands, which on its legs would tip it.
    settings += [f"robot.scenario={world.scenario}", "robot.base=welded"]
    if world.kind == "scanned":
        for file in scans_of(Path(world.stones), world.scale, number):
            (folder / file.name).symlink_to(file.resolve())
        settings += [
            f"robot.site.stones.folder={json.dumps(str(folder))}",
            f"robot.site.stones.scale={world.scale}",
        ]
    wanted = ("robot", "motion", "grasping", "monitoring")
    chosen = {
        name: plugin
        for name, plugin in load_mission("pick_and_place", settings).plugins.items()
        if name in wanted
    }
    made = assemble(chosen, "m545", FIRST_SEED + number)
    made.start()
    made.plugins["robot"].command(SwitchLidars(False))
    return Site(made.plugins, made.machine)


def run_site(world: World, ranking: str, number: int) -> Iterator[dict[str, Any]]:
    """Try the stones of one site, the largest first, and yield a row a stone."""
    with tempfile.TemporaryDirectory() as folder:
        site = lay_out(world, ranking, number, Path(folder))
    site.run(1.0)
    shapes = shapes_of(site.world.model)
    about = {
        "stones": world.kind,
        "scale": world.scale,
        "scenario": world.scenario,
        "ranking": ranking,
        "site": number,
    }
    about |= {
        "weights": weights_id() if ranking == "learned" else "",
        "found": True,
        "set_aside": None,
    }
    for i in sorted(range(A_SITE), key=lambda i: -shapes[i + 1][1]):
        tried: list[Float] = []
        attempts: list[dict[str, Any]] = []
        while len(attempts) < TRIES and not any(map(is_success, attempts)):
            attempts.append(
                attempt(site, i, tried, np.random.default_rng((number, i, len(attempts))))
            )
        flatness, mass_kg = shapes[i + 1]
        yield about | {
            "stone": i + 1,
            "flatness": round(flatness, 3),
            "mass_kg": round(mass_kg),
            "attempts": attempts,
        }


def sites_run(path: Path, world: World, ranking: str, sites: Iterable[int]) -> list[dict[str, Any]]:
    """Try those sites that are not in the file, write their rows there, return all rows."""
    done = {(world_of(row), row["ranking"], row["site"]) for row in read(path)}
    of = (world.kind, world.scale, world.scenario)
    for number in sites:
        if (of, ranking, number) in done:
            continue
        begun_s = wall_s()
        found = list(run_site(world, ranking, number))
        with path.open("a") as file:
            file.writelines(json.dumps(row) + "\n" for row in found)
        print(
            f"{world.kind} {world.scenario} {ranking} site {number}: "
            f"{sum(map(is_first, found))} of {len(found)}, {wall_s() - begun_s:.0f} s",
            flush=True,
        )
    return read(path)
