"""Stones beside what a planner sees of them: generated ones, and those of surveyed sites."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from executive_plugins.grasping.learning.labels import LabelSettings
from executive_plugins.grasping.learning.training_scene import look_at
from executive_plugins.objects.settings import SqliteObjectsSettings
from executive_plugins.objects.sqlite import SqliteObjects

from executive.arrays import Float
from executive.geometry.pose import transform
from executive.messages.cloud import Cloud
from executive.messages.stone import Stone, StoneState
from executive.mission.assembly import assemble
from executive.tree.load import load_mission
from trials.lone_stones import generated

_NEEDED = ("robot", "motion", "monitoring")  # to build a site again


@dataclass(frozen=True)
class SeenStone:
    """The corners of a stone's true hull in the map [m], shape (V, 3), and what is known of it."""

    hull: Float
    stone: Stone
    cloud: Cloud


def as_trained(count: int, seed: int) -> Iterator[SeenStone]:
    """Yield generated stones, seen as the networks' training data have them."""
    for i, (hull, solid) in enumerate(islice(generated(LabelSettings(), seed), count)):
        view = look_at(solid, (), np.random.default_rng((seed, i, 1)))
        middle = view.stone.mean(axis=0)
        known = Stone(1, StoneState.ON_GROUND, view.stone, middle, np.eye(4), True)
        yield SeenStone(hull, known, Cloud("map", view.cloud))


def as_surveyed(folders: Sequence[Path]) -> Iterator[SeenStone]:
    """Yield the stones of runs of `survey_alone.yaml` as the run knew them at its end."""
    for folder in folders:
        hulls = _true_hulls(folder)
        objects = SqliteObjects(SqliteObjectsSettings())
        objects.open(folder / "objects.sqlite", True)
        around = objects.surroundings(_map_of(folder))
        for stone in objects.stones():
            apart_m = [
                np.linalg.norm(hull.mean(axis=0)[:2] - stone.centroid_map[:2]) for hull in hulls
            ]
            yield SeenStone(hulls[int(np.argmin(apart_m))], stone, around)
        objects.close()


def _true_hulls(folder: Path) -> list[Float]:
    """Return the corners of the stones of a run's site, built again from its seed."""
    seed = json.loads((folder / "options.json").read_text())["seed"]
    plugins = load_mission("pick_and_place", ()).plugins
    made = assemble({name: plugins[name] for name in _NEEDED}, "m545", seed)
    made.start()
    world = made.plugins["robot"].world
    hulls = [transform(world.T_world_body(one.name), one.vertices) for one in world.site.stones]
    made.close()
    return hulls


def _map_of(folder: Path) -> Cloud:
    import open3d as o3d

    return Cloud("map", np.asarray(o3d.io.read_point_cloud(str(folder / "map.ply")).points))
