"""Labelled grasps: pools on generated, partly seen stones, and simulated lifts of the true stones.

There is one file per stone, which follows from the seed and the number of the stone alone. Making
labels can therefore be interrupted, continued and distributed over computers with equal results.
"""

import json
from dataclasses import dataclass
from functools import cache
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
from executive_plugins.grasping.classifier.grasp_features import features_of
from executive_plugins.grasping.classifier.weights_file import weights_file
from executive_plugins.grasping.learning.lift_trials import SHIFT_M, TURN_RAD, LiftTrials
from executive_plugins.grasping.learning.training_scene import (
    Views,
    at_rest,
    convex_solid,
    look_at,
    neighbour_place,
)
from executive_plugins.grasping.sampling.planning_cloud import PlanningCloud
from executive_plugins.grasping.sampling.pool import Pool, Sampler
from executive_plugins.grasping.sampling.ranking import (
    SPREAD_M,
    SPREAD_RAD,
    ranked_rounds,
    spread,
)
from executive_plugins.grasping.sampling.settings import SamplingSettings
from executive_plugins.grasping.simulated_lift import LIFTED_M
from executive_plugins.physics.quarried_block import block
from executive_plugins.physics.rounded_stone import rounded_stone
from executive_plugins.physics.scenario import Scenario
from numpy.typing import NDArray
from pydantic import Field

from executive.arrays import Float, Int
from executive.config import Meters, Radians, Settings
from executive.errors import ConfigError, DataError
from executive.geometry.pose import pose, transform
from executive.machine.gripper import Gripper
from executive.machine.machine import load_machine

_STAGES = (("align_rad", 40), ("enclose_m", 20))
_DESCRIPTION = "labels.json"
GRAY_LEVELS = 255.0  # a pixel value in 0 … 1 is stored as a multiple of 1 / 255


class LabelSettings(Settings):
    """How labels are made; all files of a folder have the same settings."""

    machine: str = Field(
        "m545", description="Machine whose gripper lifts: name of a shipped one, or folder."
    )
    seed: int = Field(
        1, ge=0, description="Seed; with the stone's number it determines all random draws."
    )
    grasps_per_stone: int = Field(
        24,
        ge=1,
        le=1000,
        description="Grasps per stone; half are the paper's first, half are random. With `weights` "
        "a third are the network's first.",
    )
    volume_m3: tuple[float, float] = Field(
        (0.1, 1.1), description="Least and largest volume of a stone [m³]."
    )
    rounded: float = Field(
        0.5, ge=0, le=1, description="Share of rounded stones; the others are quarried blocks."
    )
    views: Views = Field(
        "mixed",
        description="mixed: stones are seen by lidars and, in half of the scenes, by a drone; "
        "surveyed: as the map of a mission shows them after its survey.",
    )
    physics: Scenario = Field(
        "kind", description="Contacts of the lifts: those of a scenario of the simulator."
    )
    arm_error_m: Meters = Field(
        SHIFT_M, ge=0, le=0.2, description="Largest error of the gripper along each axis [m]."
    )
    arm_error_rad: Radians = Field(
        TURN_RAD, ge=0, le=0.5, description="The same of its attitude about each axis [rad]."
    )
    weights: str = Field(
        "",
        description="Network whose first choices are lifted too: shipped weights by name, or a "
        "file; none if empty. What a planner chooses looks better than it is, and labels of such "
        "grasps teach that.",
    )


@dataclass(frozen=True, slots=True, eq=False)
class Labels:
    """Grasps with their outcome.

    Attributes:
        images: Shape (M, 15, 32, 32), uint8; 255 stands for 1.
        numbers: Shape (M, 9), see `grasp_features.NUMBERS`.
        is_lifted: Whether the lift succeeded, shape (M,).
        stone: Number of each grasp's stone, shape (M,).
    """

    images: NDArray[np.uint8]
    numbers: NDArray[np.float32]
    is_lifted: NDArray[np.bool_]
    stone: Int

    def of_stones(self, is_wanted: NDArray[np.bool_]) -> "Labels":
        """Return the labels selected by a mask over grasps, shape (M,)."""
        return Labels(
            self.images[is_wanted],
            self.numbers[is_wanted],
            self.is_lifted[is_wanted],
            self.stone[is_wanted],
        )


def claim(folder: Path, settings: LabelSettings) -> None:
    """Make a folder for labels, or see that its labels have the same settings.

    Raises:
        ConfigError: If the folder holds labels with other settings.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path, wanted = folder / _DESCRIPTION, settings.model_dump(mode="json")
    if not path.exists():
        path.write_text(json.dumps(wanted, indent=2) + "\n")
    elif _defaults() | json.loads(path.read_text()) != wanted:
        raise ConfigError(
            f"{path}: the folder holds labels with settings other than {wanted}; use another folder"
        )


def _defaults() -> dict[str, Any]:
    """Return the settings of labels that were made before a setting existed."""
    return LabelSettings().model_dump(mode="json")


def read_labels(folder: Path) -> Labels:
    """Read all labels of a folder.

    Raises:
        DataError: If there are none.
    """
    files = sorted(folder.glob("stone_*.npz"))
    if not files:
        raise DataError(f"{folder}: no labels; make them with `executive grasp-data {folder}`")
    parts = [_read(path) for path in files]
    images, numbers, slip_m = (
        np.concatenate([part[name] for part in parts]) for name in ("images", "numbers", "slip")
    )
    stone = np.repeat([int(path.stem[6:]) for path in files], [len(part["slip"]) for part in parts])
    return Labels(images, numbers, slip_m <= LIFTED_M, stone)


def read_description(folder: Path) -> dict[str, object]:
    """Return the settings that the labels of a folder were made with."""
    described: dict[str, object] = json.loads((folder / _DESCRIPTION).read_text())
    return described


def stone_file(folder: Path, index: int) -> Path:
    """Return the path of the labels of a stone."""
    return folder / f"stone_{index:05d}.npz"


def _read(path: Path) -> dict[str, NDArray[np.generic]]:
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in ("images", "numbers", "slip")}


@cache
def sampler_of(machine: str) -> tuple[Gripper, Sampler]:
    """Return the gripper of a machine, by name or folder, and what samples grasps for it."""
    gripper = load_machine(machine).gripper
    return gripper, Sampler(SamplingSettings(), gripper)  # cached: tabulating takes a second


def label_stone(folder: Path, settings: LabelSettings, index: int) -> None:
    """Write the labels of one stone; its file follows from the settings and the index alone."""
    rng = np.random.default_rng((settings.seed, index))
    gripper, sampler = sampler_of(settings.machine)
    hull = resting_stone(settings, rng)
    neighbours = tuple(
        convex_solid(resting_stone(settings, rng) + neighbour_place(rng))
        for _ in range(rng.integers(3))
    )
    view = look_at(convex_solid(hull), neighbours, rng, settings.views)
    scene = sampler.scene(view.stone, view.cloud, rng)
    pool = sampler.pool(scene, rng)
    by_network = network_first(
        settings.weights, scene, pool, gripper, settings.grasps_per_stone // 3
    )
    chosen = chosen_for_lifts(pool, settings.grasps_per_stone, rng, by_network)
    trials = LiftTrials(
        gripper, hull, settings.physics, settings.arm_error_m, settings.arm_error_rad
    )
    slip_m = [
        trials.lift(scene.T_map_plan @ pose(pool.R[i], pool.position[i]), pool.jaw_rad[i], rng)
        for i in chosen
    ]
    shown = features_of(scene, pool.taken(chosen), gripper)
    images = np.round(shown.images * GRAY_LEVELS).astype(np.uint8)
    with stone_file(folder, index).open("wb") as file:
        np.savez_compressed(file, images=images, numbers=shown.numbers, slip=np.array(slip_m))


def resting_stone(settings: LabelSettings, rng: np.random.Generator) -> Float:
    """Draw stones until one comes to rest; return its corners there [m], shape (V, 3).

    Its middle is above the origin. The cube root of the volume is uniformly distributed, since a
    small stone is as hard to hold as a large one.
    """
    least, most = np.cbrt(settings.volume_m3)
    while True:
        volume_m3 = float(rng.uniform(least, most)) ** 3
        hull = (
            rounded_stone(volume_m3, rng)
            if rng.random() < settings.rounded
            else block(volume_m3, rng)
        )
        T = at_rest(hull, rng)
        if T is not None:
            corners = transform(T, hull)
            middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
            return np.asarray(corners - middle * (1.0, 1.0, 0.0))


@cache
def _net_of(weights: str) -> Any:
    """Return a network, loaded once a process; torch is imported only if there is one."""
    from executive_plugins.grasping.classifier.outcome_net import load_net

    return load_net(weights_file(weights))


def network_first(
    weights: str, scene: PlanningCloud, pool: Pool, gripper: Gripper, most: int
) -> Int:
    """Return the grasps that a planner with a network tries first, best first; none without one."""
    if not weights:
        return np.empty(0, dtype=np.int64)
    from executive_plugins.grasping.classifier.outcome_net import success

    likely = success(_net_of(weights), features_of(scene, pool, gripper))
    order = (int(i) for i in np.argsort(-likely, kind="stable"))
    tried = spread(order, pool.R, pool.position, SPREAD_M, SPREAD_RAD)
    return np.array(list(islice(tried, most)), dtype=np.int64)


def chosen_for_lifts(
    pool: Pool, most: int, rng: np.random.Generator, by_network: Int | None = None
) -> Int:
    """Choose grasps of a pool: half are the first in the order of the paper, half are random.

    A third of `most` is expected of a network; then a third are the paper's first, too.
    """
    ordered = np.concatenate(
        [*ranked_rounds(pool.costs, _STAGES, "distance_m"), np.empty(0, dtype=np.int64)]
    )
    if by_network is None or not len(by_network):
        first = ordered[: most // 2]
    else:
        papers = ordered[~np.isin(ordered, by_network)]
        first = np.concatenate([by_network, papers[: most // 3]])
    others = ordered[~np.isin(ordered, first)]
    return np.concatenate([first, rng.permutation(others)[: most - len(first)]])
