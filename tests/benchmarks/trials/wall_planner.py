"""One wall of a seed, built by the planner of dry-stone structures and, to compare, by chance."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.physics.quarried_block import block
from executive_plugins.placing.dry_stone.drops import HEIGHT, OUTSIDE, TOP, DropRules, drops
from executive_plugins.placing.dry_stone.planner import DryStone
from executive_plugins.placing.dry_stone.rasters import WallTop, raster_of
from executive_plugins.placing.dry_stone.settings import DryStoneSettings
from executive_plugins.placing.judge import shape_of
from executive_plugins.placing.trial_site import RigidStones
from scipy.spatial.transform import Rotation

from executive.clouds.meshes.reader import mesh_of
from executive.commands.walls.construction import Trial, TrialRules, answer_of, build
from executive.errors import ConfigError
from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import pose
from executive.interfaces.building import MayGoOn, StructurePlanner
from executive.messages.building import AsBuilt, BuildPlan, BuildTarget
from executive.messages.height_grid import HeightGrid
from executive.messages.solid_stone import SolidStone
from executive.messages.structure import Structure
from executive.mission.judging import verdict_of
from trials.known_stones_planner import KnownStonesPlanner, as_it_lies

SCALE, DENSITY_KG_M3 = 8.0, 2600.0
SCANS, BLOCKS = 30, 10  # of an inventory
BLOCK_M3 = (0.15, 0.6)  # volumes of generated blocks
NOISE = (0.03, np.radians(2.0))
ON_STONES_M = 0.10  # least height above the ground of a stone that lies on others
_DRAWN = 200  # stones and rotations that are drawn for one legal drop
ENOUGH, ENOUGH_KNOWN, IN_SEEDS = 17, 12, 0.8  # stones, in this share of the seeds
RIGHT, RIGHT_KNOWN = 0.95, 0.90


@dataclass(frozen=True, slots=True)
class Job:
    """What one seed is given; `scans_as_known` stones are known as in a mission, or all of each."""

    seed: int
    folder: Path
    most: int
    drops: int
    budget_s: float
    is_judged: bool
    keep: Path | None
    scans_as_known: int | None = None


class AnyLegalDrop(StructurePlanner):
    """Lets a stone down wherever it may lie: any stone, turned anyhow, anywhere on the others.

    Legal is what the generator of `dry_stone` calls so, without its demand of a support below the
    centre of mass and without its broad sides: the stone touches others first, meets none on its
    way, and is in the envelope. There is no score and no check.
    """

    def propose(
        self,
        built: AsBuilt,
        inventory: Sequence[SolidStone],
        rng: np.random.Generator,
        may_go_on: MayGoOn = lambda: True,
    ) -> BuildPlan:
        """Return the first drop that is legal, of some hundred that are drawn."""
        s = DryStoneSettings()
        usable = [one for one in inventory if one.mass_kg <= s.max_mass
                  and one.extents_m[0] <= s.slenderest * one.extents_m[2]]  # fmt: skip
        wall, structure = WallTop(built, s.generator.cell), built.structure
        lean = float(np.tan(structure.batter_rad))
        over_top_m = float(np.median([stone.extents_m[2] for stone in usable])) / 2
        rules = DropRules(s.generator.touch, lean, lean, 1, s.generator.most_outside,
                          structure.height_m + over_top_m)  # fmt: skip
        for _ in range(_DRAWN):
            stone = usable[rng.integers(len(usable))]
            R = Rotation.random(rng=rng).as_matrix()
            raster = raster_of(stone.vertices, stone.triangles, R, wall.cell_m)
            nodes, found = drops(wall, raster, rules)
            bottom_m = found[:, TOP] - (raster.over.max() - raster.under.min())
            is_legal = (found[:, OUTSIDE] <= rules.most_outside) & (bottom_m > ON_STONES_M)
            legal = np.flatnonzero(is_legal & np.isfinite(found[:, TOP]))
            if len(legal):
                n = rng.choice(legal)
                xy = (nodes[n] + wall.corner) * wall.cell_m
                T, down = pose(R, np.array([*xy, found[n, HEIGHT]])), np.array([0.0, 0.0, -1.0])
                target = BuildTarget(stone.name, T, T, down, 0.0, 0.0, 0.0, 0.0, {})
                return BuildPlan((target,), None, {})
        return BuildPlan((), "nothing_fits", {}, f"none of {_DRAWN} drops is legal")


def wall(job: Job) -> dict[str, Any]:
    """Build the wall of a seed, and return its figures."""
    rng = np.random.default_rng(job.seed)
    planner: StructurePlanner = DryStone(DryStoneSettings())
    if job.scans_as_known is not None:
        drawn = inventory(job.folder, rng, job.scans_as_known, 0)
        stones = tuple(as_it_lies(one, rng) for one in drawn)
        planner = KnownStonesPlanner(stones, rng)
    else:
        stones = inventory(job.folder, rng)
    rules = TrialRules(NOISE, job.most, job.budget_s)
    trial = build(bare(), stones, planner, RigidStones(), rules, rng)
    told = {"seed": job.seed, "inventory": len(stones), **answer_of(trial)}
    if job.drops:
        told["dropped"] = dropped(trial, stones, job, rng)
    if trial.placed:
        judged = verdict_of(trial.built, "rigid_stones") if job.is_judged else shape_of(trial.built)
        told["verdict"] = dict(judged)
    if job.keep:
        (job.keep / f"wall_{job.seed}.json").write_text(json.dumps(told), encoding="utf-8")
    return told


def dropped(
    trial: Trial, stones: Sequence[SolidStone], job: Job, rng: np.random.Generator
) -> list[bool]:
    """Return which legal drops onto the structure, as it stood at times, settle where they should.

    A time at which no legal place is found is left out.
    """
    planner, site, rules = AnyLegalDrop(), RigidStones(), TrialRules(NOISE, 1)
    times = np.linspace(0, len(trial.placed) - 1, min(job.drops, len(trial.placed)))
    found = []
    for number in np.unique(times.round().astype(int)):
        built = trial.placed[number].built
        used = {one.stone.name for one in built.standing}
        left = [one for one in stones if one.name not in used]
        one_more = build(built, left, planner, site, rules, rng)
        found += [one.is_right for one in one_more.placed]
    return found


def bare() -> AsBuilt:
    """Return the wall of which nothing stands."""
    line = np.array([[-3.0, 0.0], [3.0, 0.0]])
    ground = HeightGrid.plane(np.array([-7.0, -4.0]), np.array([7.0, 4.0]))
    return AsBuilt(Structure("wall", line, 1.3, 1.5, np.radians(3.0)), ground)


def inventory(
    folder: Path, rng: np.random.Generator, scans: int = SCANS, blocks: int = BLOCKS
) -> tuple[SolidStone, ...]:
    """Return scans and generated blocks, drawn by the generator."""
    files = sorted(folder.glob("*.obj"))
    if len(files) < scans:
        raise ConfigError(f"{folder}: {len(files)} scans, {scans} are needed")
    stones = []
    for path in rng.permutation(np.array(files))[:scans]:
        vertices, triangles = mesh_of(path)
        stones.append(SolidStone.of_mesh(path.stem, vertices * SCALE, triangles, DENSITY_KG_M3))
    for number in range(blocks):
        corners, faces = hull_mesh(block(float(rng.uniform(*BLOCK_M3)), rng))
        stones.append(SolidStone.of_mesh(f"block_{number}", corners, faces, DENSITY_KG_M3))
    return tuple(stones)


def figures(found: Sequence[Mapping[str, Any]], as_known: bool = False) -> list[Figure]:
    """Return the figures of all seeds against their bounds."""
    least, least_right = (ENOUGH_KNOWN, RIGHT_KNOWN) if as_known else (ENOUGH, RIGHT)
    placed = [one for wall in found for one in wall["placed"]]
    counts = [len(wall["placed"]) for wall in found]
    right = sum(one["is_right"] for one in placed) / max(1, len(placed))
    enough = sum(n >= least for n in counts) / len(counts)
    cpu = [one["planning_cpu_s"] for one in placed] or [np.nan]
    errors = [one["error_m"] for one in placed] or [np.nan]
    drops = [is_right for wall in found for is_right in wall.get("dropped", ())]
    told = [
        held(f"share of walls with {least} stones", enough, Bound(IN_SEEDS, is_least=True),
             f"{enough:.2g}; stones by seed: {counts}"),
        held("stones that settle within 10 cm and 10° of the plan", right,
             Bound(least_right, is_least=True), f"{right:.3f} of {len(placed)}"),
        held("planning a stone, median [s of processor time]", float(np.median(cpu)), Bound(15, 5)),
        held("planning a stone, p95 [s of processor time]", float(np.quantile(cpu, 0.95)),
             Bound(30, 10)),
        Figure("settled against planned, median / p90 [m]",
               f"{np.median(errors):.3f} / {np.quantile(errors, 0.9):.3f}"),
    ]  # fmt: skip
    if drops:
        chance = max(sum(drops), 1) / len(drops)  # none right counts as one: a bound from below
        words = f"{right / chance:.1f}; any legal drop: {sum(drops)} of {len(drops)} right"
        told.append(held("right, over any legal drop", right / chance, Bound(5, 8, True), words))
    return told + _judged([wall["verdict"] for wall in found if "verdict" in wall])


def _judged(verdicts: Sequence[Mapping[str, Any]]) -> list[Figure]:
    """Return the worst of the walls, as the judge saw them."""
    if not verdicts:
        return []
    bounds = {
        "drift_20s_m": Bound(0.01, 0.003),
        "tilt_across_deg": Bound(8, 12, True),
        "tilt_along_deg": Bound(12, 18, True),
        "tilt_across_slippery_deg": Bound(6, 9, True),
        "pushed_m": Bound(0.10, 0.03),
        "fill": Bound(0.58, 0.66, True),
        "running_joints": Bound(0.25, 0.10),
    }
    told = []
    for name, bound in bounds.items():
        if not any(name in verdict for verdict in verdicts):
            continue  # no trial was made: it was not asked for
        values = [float(v[name]) for v in verdicts if v[name] is not None] or [np.nan]
        worst = min(values) if bound.is_least else max(values)
        words = f"{worst:.3g}; by seed: " + ", ".join(f"{value:.3g}" for value in values)
        told.append(held(f"judge: {name}, worst", worst, bound, words))
    return told
