"""The parts of the dry-stone planner on boxes and rough blocks, along walls, rings and cairns."""

from dataclasses import replace

import numpy as np
import pytest
from executive_plugins.placing.dry_stone.drops import DropRules, drops
from executive_plugins.placing.dry_stone.height_maps import HeightMaps
from executive_plugins.placing.dry_stone.orientations import orientations
from executive_plugins.placing.dry_stone.planner import DryStone
from executive_plugins.placing.dry_stone.rasters import WallTop, raster_at, raster_of
from executive_plugins.placing.dry_stone.settings import (
    DryStoneSettings,
    GeneratorSettings,
    ScorerSettings,
)
from executive_plugins.placing.dry_stone.weighted import Weighted
from executive_plugins.placing.fill import fill_of
from executive_plugins.placing.judge import _running_joints
from executive_plugins.placing.side_by_side import SideBySide, SideBySideSettings
from scipy.spatial import ConvexHull

from executive.geometry.hull_mesh import hull_mesh
from executive.geometry.pose import pose
from executive.geometry.rotation import from_rpy
from executive.messages.building import AsBuilt, StandingStone
from executive.messages.height_grid import HeightGrid
from executive.messages.solid_stone import SolidStone
from executive.messages.structure import Structure
from executive.testing.exercises.building import bare, box, boxes, first_course

# Areas and normals of a hull are computed by a library, which may add them in another order.
SOLVED = 1e-7


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def rough(name: str, seed: int, size_m: float = 0.5) -> SolidStone:
    """Return a convex stone of ten corners."""
    corners = rng(seed).normal(size=(10, 3))
    corners *= np.array([1.0, 0.7, 0.5]) * size_m / np.linalg.norm(corners, axis=1)[:, None]
    return SolidStone.of_mesh(name, *hull_mesh(corners), 2600.0)


def slope(tilt_rad: float = 0.08) -> HeightGrid:
    return HeightGrid.plane(np.array([-4.0, -4.0]), np.array([4.0, 4.0]), tilt_rad)


def diagonal() -> AsBuilt:
    """Return a leaning wall at 45° on a slope, with two stones of which one is turned."""
    line = np.array([[-1.0, -1.0], [0.25, 0.25], [1.0, 1.0]])
    built = AsBuilt(Structure("diagonal", line, 0.8, 0.9, 0.15, 1), slope())
    first = StandingStone(box("first", 0.9, 0.6, 0.4), pose(from_rpy(0, 0, 0.8), np.zeros(3)))
    second = StandingStone(
        rough("second", 1), pose(from_rpy(0.1, -0.2, 2.0), np.array([0.8, 0.7, 0.3]))
    )
    return built.with_standing(first, second)


def ring() -> AsBuilt:
    angles = np.linspace(0, 2 * np.pi, 13)
    line = 1.2 * np.column_stack([np.cos(angles), np.sin(angles)])
    line[-1] = line[0]
    stone = StandingStone(box("on_ring", 0.5, 0.5, 0.4), pose(t=np.array([1.2, 0.0, 0.2])))
    return AsBuilt(Structure("ring", line, 0.7, 0.8, 0.1), bare().ground).with_standing(stone)


def cairn() -> AsBuilt:
    return AsBuilt(Structure("cairn", np.array([[0.25, -0.5]]), 1.4, 0.9, 0.2), slope(-0.05))


SITES = {"wall": first_course, "diagonal": diagonal, "ring": ring, "cairn": cairn}


def test_orientations(recorded) -> None:
    told = []
    for stone in (box("a", 0.9, 0.6, 0.3), rough("b", 2), rough("c", 3)):
        for sides, turns, first_rad in ((None, 1, 0.7), (1, 3, 0.0), (3, 2, -2.0), (20, 1, 0.4)):
            told.append(orientations(stone.vertices, sides, turns, first_rad))
    recorded(told, relative=SOLVED)


def test_rasters(recorded) -> None:
    told = []
    for stone in (box("a", 0.9, 0.6, 0.3), rough("b", 4)):
        for R, cell_m in ((np.eye(3), 0.1), (from_rpy(0.4, -0.7, 1.1), 0.06)):
            told.append(raster_of(stone.vertices, stone.triangles, R, cell_m))
        T = pose(from_rpy(0.2, 0.1, -0.5), np.array([0.33, -0.21, 0.4]))
        told.append(raster_at(stone.vertices, stone.triangles, T, 0.08))
    recorded(told)


@pytest.mark.parametrize("site", SITES)
def test_tops(recorded, site) -> None:
    told = []
    for cell_m in (0.1, 0.16):
        top = WallTop(SITES[site](), cell_m)
        told.append((top.corner, top.top, top.owner, top.ground, top.room))
        told.append([top.share_up_to(height_m) for height_m in (0.0, 0.1, 0.39, 0.5)])
    recorded(told)


@pytest.mark.parametrize("site", SITES)
def test_drops(recorded, site) -> None:
    built, told = SITES[site](), []
    top = WallTop(built, 0.1)
    for stone, R in ((box("a", 0.7, 0.5, 0.3), np.eye(3)), (rough("b", 5), from_rpy(0.3, 0.2, 1))):
        raster = raster_of(stone.vertices, stone.triangles, R, 0.1)
        for rules in (
            DropRules(0.03, 0.0, 0.0, 1),
            DropRules(0.1, 0.2, 0.1, 2, 0.12),
            DropRules(0.02, 0.1, 0.0, 3, 0.4),
        ):
            told += drops(top, raster, rules)
    recorded(told)


@pytest.mark.parametrize("site", SITES)
def test_places(recorded, site) -> None:
    built, told = SITES[site](), []
    stones = (box("a", 0.7, 0.5, 0.3), rough("b", 6))
    for settings in (
        GeneratorSettings(cell=0.1, sides=2, turns=2),
        GeneratorSettings(cell=0.1, attitude="kept", turns=3, stride=1, most_outside=0.3),
        GeneratorSettings(cell=0.12, sides=1, turns=1, over_top=0.0, touch=0.1),
    ):
        scorer = Weighted(ScorerSettings())
        for of_stone in HeightMaps(settings).places(built, stones, rng(), lambda: True):
            scores = [scorer.score(one, built, stones) for one in of_stone]
            told.append([len(one.origins_map) for one in of_stone])
            told.append(np.vstack([one.origins_map for one in of_stone]))
            for rows in ([one.measured for one in of_stone], scores):
                told.append({name: np.concatenate([row[name] for row in rows]) for name in rows[0]})
        assert list(HeightMaps(settings).places(built, stones, rng(), lambda: False)) == []
    recorded(told, relative=SOLVED)


@pytest.mark.parametrize("site", SITES)
def test_plans(recorded, site) -> None:
    told = []
    for generator in ({"kept": 1, "stones": 1}, {"kept": 2, "attitude": "kept"}):
        generator = {"cell": 0.1, "sides": 2, "turns": 2, **generator}
        settings = {"check": {"part": "none"}, "generator": generator}
        planner = DryStone(DryStoneSettings.model_validate(settings))
        plan = planner.propose(SITES[site](), (*boxes(), rough("rough", 7)), rng())
        told.append(plan)
    recorded(told, relative=SOLVED)


def test_side_by_side(recorded) -> None:
    stones, told = (*boxes(), rough("rough", 8)), []
    for site in ("wall", "diagonal", "ring"):
        built = replace(SITES[site](), standing=())
        for gap in (0.0, 0.25):
            planner = SideBySide(SideBySideSettings(gap=gap))
            for inventory in (stones, stones[::-1], (box("long", 9.0, 0.5, 0.4), stones[4]), ()):
                told.append(planner.propose(built, inventory, rng()))
            course = built.with_standing(
                StandingStone(stones[0], pose(t=np.array([-0.4, -0.2, 0.2])))
            )
            told += [planner.propose(course, stones[k:], rng()) for k in (0, 3)]
    recorded(told, relative=SOLVED)


@pytest.mark.parametrize("site", SITES)
def test_fill(recorded, site) -> None:
    built = SITES[site]()
    recorded([fill_of(built), fill_of(replace(built, standing=built.standing[:1]))])


def test_joints(recorded) -> None:
    """Stones beside and over one another, at each limit of what is beside, above and covered."""
    told = []
    for angle_rad in (0.0, 0.6):
        R = from_rpy(0, 0, angle_rad)
        line = np.array([[-2.0, 0.0], [2.0, 0.0]]) @ R[:2, :2].T
        empty = AsBuilt(Structure("wall", line, 0.8, 1.5), bare().ground)
        foot = [(-0.75, 0.2), (0.0, 0.2), (0.75, 0.25)]
        for above in (
            [],
            [(0.0, 0.6)],
            [(-0.375, 0.6)],
            [(-0.3, 0.6), (0.55, 0.6)],
            [(-0.45, 0.6), (0.45, 0.6)],
            [(0.375, 0.45)],
            [(0.375, 0.56), (-0.4, 0.95)],
        ):
            at = [R @ np.array([x, 0.0, z]) for x, z in (*foot, *above)]
            stones = [
                StandingStone(box(f"s{k}", 0.7, 0.6, 0.4), pose(R, one)) for k, one in enumerate(at)
            ]
            told.append(_running_joints(empty.with_standing(*stones)))
    recorded(told)


def test_the_blocks_of_these_cases_are_convex() -> None:
    stone = rough("a", 1)
    assert ConvexHull(stone.vertices).volume == pytest.approx(stone.volume_m3)
