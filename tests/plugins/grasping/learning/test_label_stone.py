"""The labels of one stone, with a scene, a pool and lifts that are made up."""

from collections import Counter
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from executive_plugins.grasping.learning import labels
from executive_plugins.grasping.learning.labels import (
    LabelSettings,
    claim,
    label_stone,
    read_description,
    read_labels,
    sampler_of,
    stone_file,
)
from executive_plugins.grasping.sampling.pool import Pool

from executive.errors import ConfigError
from executive.geometry.pose import inverse, pose
from executive.geometry.rotation import from_rpy
from executive.machine.machine import load_machine

COUNT = 9  # grasps of the pool
T_MAP_PLAN = pose(from_rpy(0.1, 0.2, 0.3), np.array([4.0, 1.0, 0.5]))
GRIPPER = object()


class Bench:
    """Stands in for all that takes time, and keeps what it was asked."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.neighbours: list[Any] = []
        self.lifts: list[tuple[Any, float]] = []
        self.asked: list[Any] = []
        self.views: list[str] = []
        self.made: list[Any] = []
        turns = np.repeat(np.eye(3)[None], COUNT, axis=0)
        places = np.arange(COUNT)[:, None] * [1.0, 0.0, 0.0]
        # A later grasp is the nearer.
        costs = {name: np.zeros(COUNT) for name in ("align_rad", "enclose_m")}
        costs["distance_m"] = np.arange(COUNT, 0.0, -1.0)
        never = np.zeros(COUNT, dtype=int)
        self.pool = Pool(turns, places, 0.1 * np.arange(COUNT), costs, Counter(), never)
        scene = SimpleNamespace(T_map_plan=T_MAP_PLAN)
        sampler = SimpleNamespace(
            scene=lambda stone, cloud, rng: scene, pool=lambda scene, rng: self.pool
        )
        for name, stand_in in {
            "sampler_of": lambda machine: (GRIPPER, sampler),
            "resting_stone": lambda settings, rng: rng.uniform(size=(4, 3)),
            "convex_solid": lambda hull: hull,
            "neighbour_place": lambda rng: np.array([100.0, 0.0, 0.0]),
            "look_at": self._look_at,
            "network_first": self._network_first,
            "LiftTrials": self._trials,
            "features_of": self._features,
        }.items():
            monkeypatch.setattr(labels, name, stand_in)

    def _look_at(self, stone: Any, neighbours: Any, rng: Any, views: str) -> Any:
        self.neighbours.append(neighbours)
        self.views.append(views)
        return SimpleNamespace(stone=stone, cloud=stone)

    def _network_first(self, weights: str, scene: Any, pool: Any, gripper: Any, most: int) -> Any:
        self.asked.append((weights, gripper is GRIPPER, most))
        return np.empty(0, dtype=np.int64)

    def _trials(self, *given: Any) -> Any:
        self.made.append(given)

        def lift(T_map_gripper: Any, jaw_rad: float, rng: Any) -> float:
            self.lifts.append((T_map_gripper, jaw_rad))
            return 0.1 * len(self.lifts)

        return SimpleNamespace(lift=lift)

    def _features(self, scene: Any, taken: Pool, gripper: Any) -> Any:
        shades = taken.position[:, 0] / 255 + 0.4 / 255  # rounded, not cut off
        return SimpleNamespace(
            images=np.repeat(shades[:, None], 5, axis=1), numbers=taken.jaw_rad[:, None]
        )


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Bench:
    return Bench(monkeypatch)


def test_each_chosen_grasp_is_lifted_where_it_is_in_the_map_and_stored(
    bench: Bench, tmp_path: Path
) -> None:
    settings = LabelSettings(
        grasps_per_stone=6, arm_error_m=0.03, arm_error_rad=0.07, physics="nominal", weights="mine",
        views="surveyed",
    )  # fmt: skip
    label_stone(tmp_path, settings, 12)
    places = [inverse(T_MAP_PLAN) @ T for T, _ in bench.lifts]
    chosen = [round(T[0, 3]) for T in places]
    assert len(set(chosen)) == 6
    assert chosen[:3] == [8, 7, 6]  # half are the first in the order of the paper
    for number, T, (_, jaw_rad) in zip(chosen, places, bench.lifts, strict=True):
        np.testing.assert_allclose(T, pose(t=np.array([number, 0.0, 0.0])), atol=1e-12)
        assert jaw_rad == pytest.approx(0.1 * number)
    assert bench.asked == [("mine", True, 2)]
    assert bench.views == ["surveyed"]
    ((gripper, hull, *errors),) = bench.made
    assert gripper is GRIPPER
    assert hull.shape == (4, 3)
    assert errors == ["nominal", 0.03, 0.07]
    stored = read_labels(tmp_path)
    assert stored.images.dtype == np.uint8
    assert stored.images[:, 0].tolist() == chosen
    np.testing.assert_allclose(stored.numbers[:, 0], 0.1 * np.array(chosen), atol=1e-6)
    assert stored.is_lifted.tolist() == [True, True, False, False, False, False]  # 0.1 m, 0.2 m, …
    assert stored.stone.tolist() == [12] * 6


def test_a_stone_follows_from_seed_and_number_and_has_up_to_two_neighbours(
    bench: Bench, tmp_path: Path
) -> None:
    for number in range(12):
        label_stone(tmp_path, LabelSettings(seed=3), number)
    counts = [len(one) for one in bench.neighbours]
    assert set(counts) == {0, 1, 2}
    for one in bench.neighbours:
        for hull in one:
            assert (hull[:, 0] > 99.0).all()  # it lies at its own place
    hulls = [hull for _, hull, *_ in bench.made]
    assert len({hull.tobytes() for hull in hulls}) == 12
    label_stone(tmp_path, LabelSettings(seed=3), 5)
    np.testing.assert_array_equal(bench.made[-1][1], hulls[5])
    label_stone(tmp_path, LabelSettings(seed=4), 5)
    assert not np.array_equal(bench.made[-1][1], hulls[5])
    assert stone_file(tmp_path, 5).name == "stone_00005.npz"


def test_a_folder_describes_its_labels_and_keeps_others_out(tmp_path: Path) -> None:
    folder, settings = tmp_path / "a" / "b", LabelSettings(seed=7)
    claim(folder, settings)
    claim(folder, settings)
    assert read_description(folder)["seed"] == 7
    assert LabelSettings.model_validate(read_description(folder)) == settings
    with pytest.raises(ConfigError, match="use another folder"):
        claim(folder, LabelSettings(seed=8))


def test_a_machine_has_one_sampler_for_its_own_gripper() -> None:
    gripper, sampler = sampler_of("mini")
    assert gripper.tip_force_n == load_machine("mini").gripper.tip_force_n
    assert sampler_of("mini")[1] is sampler
