"""The pictures of docs/grasping.md.

`grasping_costs.png`: the three costs of all grasps of a pool and of the chosen one, for a round and
a flat stone, after Fig. 9 of Mascaro 2020. `grasping_good.png` and `grasping_failed.png`: the first
of some generated stones on which the learned ranking's first grasp lifts in all of four noisy
trials and the paper's ranking's first in none.
"""

from itertools import islice
from pathlib import Path

import numpy as np
from bounds import Figure, judged
from executive_plugins.grasping.learning.labels import LabelSettings
from executive_plugins.grasping.learning.lift_trials import LiftTrials
from executive_plugins.grasping.learning.training_scene import StoneView, convex_solid, look_at
from executive_plugins.grasping.sampled_antipodal import SampledAntipodal
from executive_plugins.grasping.sampled_cnn import SampledCnn
from executive_plugins.grasping.sampled_planner import SampledPlanner
from executive_plugins.grasping.sampling.pool import Pool, Sampler
from executive_plugins.grasping.sampling.ranking import paper_costs
from executive_plugins.grasping.sampling.settings import SamplingSettings
from executive_plugins.grasping.settings import SampledAntipodalSettings, SampledCnnSettings
from executive_plugins.grasping.simulated_lift import LIFTED_M
from matplotlib import figure as plots

from executive.arrays import Float
from executive.commands.chosen import chosen
from executive.commands.grasps.picture import draw_grasp
from executive.geometry.pose import inverse
from executive.interfaces.motion import MotionPlanner
from executive.machine.machine import Machine, load_machine
from executive.messages.cloud import Cloud
from executive.messages.grasp import Grasp
from executive.messages.stone import Stone, StoneState
from trials.lone_stones import generated

SEED, LIFTS = 91, 4
STANDS = np.array([[1, 0, 0, -5.5], [0, 1, 0, 0], [0, 0, 1, 0.9], [0, 0, 0, 1]], dtype=float)
SHAPES_M = {"round": (0.55, 0.52, 0.5), "flat": (0.75, 0.6, 0.22)}  # half axes of ellipsoids
COSTS = {
    "align_rad": "alignment [rad]",
    "enclose_m": "enclosing [m]",
    "distance_m": "distance to the centre [m]",
}


def ellipsoid(half_m: tuple[float, float, float], corners: int = 400) -> Float:
    """Return corners of an ellipsoid that rests on the ground."""
    i = np.arange(corners) + 0.5  # Fibonacci's spiral: even over the sphere
    polar, azimuth = np.arccos(1 - 2 * i / corners), np.pi * (1 + 5**0.5) * i
    ring = np.sin(polar)
    unit = np.column_stack([np.cos(azimuth) * ring, np.sin(azimuth) * ring, np.cos(polar)])
    return np.asarray(unit * half_m + (0.0, 0.0, half_m[2]))


def best(planner: SampledPlanner, view: StoneView, seed: int) -> Grasp | None:
    seen = Stone(1, StoneState.ON_GROUND, view.stone, view.stone.mean(axis=0), np.eye(4), True)
    grasps = planner.plan(
        seen, Cloud("map", view.cloud), STANDS, np.random.default_rng(seed)
    ).grasps
    return grasps[0] if grasps else None


def draw_costs(path: Path, planners: dict[str, SampledPlanner], machine: Machine) -> None:
    """Draw a row of histograms for each shape, and in each the costs of what each ranking chose."""
    figure = plots.Figure(figsize=(11, 5.5), layout="constrained")
    rows = figure.subplots(len(SHAPES_M), len(COSTS))
    sampler = Sampler(SamplingSettings(), machine.gripper)
    for axes, (name, half_m) in zip(rows, SHAPES_M.items(), strict=True):
        view = look_at(convex_solid(ellipsoid(half_m)), (), np.random.default_rng(SEED))
        rng = np.random.default_rng(0)
        scene = sampler.scene(view.stone, view.cloud, rng)
        pool: Pool = sampler.pool(scene, rng)
        for one, (cost, label) in zip(axes, COSTS.items(), strict=True):
            one.hist(pool.costs[cost], bins=24, color="0.8")
            one.set(xlabel=label)
        for (colour, width), (ranking, planner) in zip(
            (("tab:red", 4.0), ("tab:blue", 1.5)), planners.items(), strict=True
        ):
            grasp = best(planner, view, 0)
            if grasp is None:
                continue
            T = inverse(scene.T_map_plan) @ grasp.T_map_gripper
            costs = paper_costs(T[None, :3, :3], T[None, :3, 3], scene.centre, scene.ground.normal)
            for one, cost in zip(axes, COSTS, strict=True):
                one.axvline(
                    costs[cost][0], color=colour, linewidth=width, label=f"first by {ranking}"
                )
        axes[0].set(ylabel=f"{name}: {len(pool)} grasps")
    rows[0][-1].legend(fontsize="small")
    figure.savefig(path, dpi=110)


def draw_pair(
    folder: Path, planners: dict[str, SampledPlanner], machine: Machine, stones: int
) -> bool:
    """Draw what two rankings choose on the first stone on which one always lifts and the other
    never; return whether there is one.
    """
    gripper = machine.gripper
    for i, (hull, solid) in enumerate(islice(generated(LabelSettings(), SEED), stones)):
        view, trials = (
            look_at(solid, (), np.random.default_rng((SEED, i))),
            LiftTrials(gripper, hull),
        )
        grasps = {ranking: best(planner, view, i) for ranking, planner in planners.items()}
        lifted = {}
        for ranking, grasp in grasps.items():
            chance = np.random.default_rng((SEED, i, 1))
            slips = (
                [trials.lift(grasp.T_map_gripper, gripper.open_rad, chance) for _ in range(LIFTS)]
                if grasp
                else []
            )
            lifted[ranking] = sum(slip <= LIFTED_M for slip in slips)
        print(f"stone {i}: lifts of {LIFTS}: {lifted}", flush=True)
        paper, learned = grasps["the paper's stages"], grasps["predicted success"]
        if (
            paper
            and learned
            and lifted["predicted success"] == LIFTS
            and lifted["the paper's stages"] == 0
        ):
            title = (
                f"stone {i}, first by predicted success: lifted in {LIFTS} of {LIFTS} noisy trials"
            )
            draw_grasp(
                folder / "grasping_good.png", learned, view.stone, view.cloud, gripper, title
            )
            title = f"stone {i}, first by the paper's stages: lifted in 0 of {LIFTS} noisy trials"
            draw_grasp(
                folder / "grasping_failed.png", paper, view.stone, view.cloud, gripper, title
            )
            return True
    return False


def drawn(folder: Path, stones: int) -> list[Figure]:
    """Draw all pictures; a picture for which no stone serves is a miss."""
    machine = load_machine("m545")
    with chosen(MotionPlanner) as motion:
        planners: dict[str, SampledPlanner] = {
            "the paper's stages": SampledAntipodal(
                SampledAntipodalSettings(rehearsed=0), machine, motion
            ),
            "predicted success": SampledCnn(SampledCnnSettings(), machine, motion),
        }
        for planner in planners.values():
            planner.start()
        draw_costs(folder / "grasping_costs.png", planners, machine)
        has_pair = draw_pair(folder, planners, machine, stones)
    return [judged("pictures drawn", f"{3 if has_pair else 1} of 3", "all", has_pair)]
