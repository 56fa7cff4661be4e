"""What `other_sites.py` measures."""

from collections import Counter
from collections.abc import Iterable, Sequence
from types import ModuleType

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings
from perception.drawn_sites import DrawnSite, SiteDraft, Terrain, box
from perception.piles import load_scenes
from scipy.spatial import cKDTree

from executive.arrays import Float
from executive.machine.machine import load_machine
from executive.messages.cloud import Cloud
from executive.messages.segment import Segmentation

COVERED = 0.5  # intersection over union of a segment and its stone
TERRAINS = {
    "waves of 0.3 m, 5 m long": Terrain(0.3, 5.0),
    "waves of 0.3 m, 8 m long": Terrain(0.3, 8.0),
    "waves of 0.3 m, 12 m long, on 10 degrees": Terrain(0.3, 12.0, np.radians(10)),
    "a slope of 12 degrees": Terrain(slope_rad=np.radians(12)),
    "a slope of 25 degrees": Terrain(slope_rad=np.radians(25)),
}
STONES, ON_CRESTS, APART_M = 8, 3, 2.6
_TRIES = 30  # places that are tried for stones on crests: long waves have few
SEEN, FALSE = Bound(99.0, 100.0, is_least=True), Bound(0.5)
CLASSED, KEPT = Bound(100.0, is_least=True), Bound(95.0, 100.0, is_least=True)
WRONG = ("wall", "thin wall", "boulder", "person", "facade", "kerb", "car", "lamp", "pebble")


def measured(seeds: Iterable[int]) -> list[Figure]:
    """Segment all sites with the plugin of the shipped missions."""
    scenes, seeds = load_scenes(), list(seeds)
    plugin = GroundAndClusters(GroundAndClustersSettings(), load_machine("m545"))
    plugin.start()
    figures, all_segments, all_false = [], 0, 0
    for name, terrain in TERRAINS.items():
        tally = Counter[str]()
        for seed in seeds:
            site = stones_on(terrain, seed, scenes)
            tally.update(_stones(site, plugin.segment(Cloud("map", site.points))))
        words = f"{tally['seen']} of {tally['stones']}, {tally['false']} false segments"
        figures.append(
            held(f"stones on {name} [%]", 100 * tally["seen"] / tally["stones"], SEEN, words)
        )
        all_segments, all_false = all_segments + tally["segments"], all_false + tally["false"]
    share = 100 * all_false / max(all_segments, 1)
    figures.append(held("their segments that are no stone [%]", share, FALSE))
    return [*figures, *_others(plugin, seeds, scenes)]


def stones_on(terrain: Terrain, seed: int, scenes: ModuleType) -> DrawnSite:
    """Return eight stones on a terrain, three of them on crests where it has some."""
    rng = np.random.default_rng(seed)
    draft, spots = SiteDraft(scenes, rng, terrain), list[Float]()
    crests = iter(terrain.crest_near(spot) for spot in rng.uniform(-6.5, 6.5, (_TRIES, 2)))
    while len(spots) < STONES:
        spot = next(crests, None) if len(spots) < ON_CRESTS else None
        spot = rng.uniform(-6.5, 6.5, 2) if spot is None else spot
        if np.abs(spot).max() < 6.5 and all(np.linalg.norm(spot - o) > APART_M for o in spots):
            spots.append(spot)
            draft.add("stone", scenes._stone(rng) * rng.uniform(0.5, 1.0), spot)
    return draft.seen(160_000)


def yard(seed: int, scenes: ModuleType) -> DrawnSite:
    """Return stones among walls, a boulder, two joined stones, pebbles, a person, a machine."""
    rng = np.random.default_rng(seed)
    draft = SiteDraft(scenes, rng, Terrain(0.05, 9.0, 0.03))
    draft.add("wall", box((5, 0.4, 1.2), rng.uniform(-0.5, 0.5)), np.array([-4.0, 5.5]))
    draft.add("thin wall", box((3.5, 0.06, 1.2), rng.uniform(0.8, 1.2)), np.array([5.0, 5.0]))
    draft.add("boulder", scenes._stone(rng) * rng.uniform(2.6, 3.0), np.array([5.0, -4.0]))
    draft.add("person", box((0.45, 0.3, 1.75), rng.uniform(0, 3)), np.array([0.0, -6.0]))
    one, other = scenes._stone(rng) * 1.2, scenes._stone(rng) * 1.2
    apart_m = (np.ptp(one[:, 0]) + np.ptp(other[:, 0])) / 2
    draft.add("joined stone", one, np.array([-0.5, 3.5]))
    draft.add("joined stone", other, np.array([-0.5 + 0.92 * apart_m, 3.5]))
    for k in range(3):
        draft.add("pebble", scenes._stone(rng) * 0.13, np.array([2.0 + 0.8 * k, -6.5]))
    for spot in ((0, 0), (3, 1), (-3, 0), (0, -3)):
        draft.add("stone", scenes._stone(rng), np.array(spot) + rng.uniform(-0.3, 0.3, 2))
    hull = ((2.6, 1.6, 0.8), (3.4, 0.4, 0.6), (3.4, 0.4, 0.6), (1, 1, 1.1), (2.5, 0.3, 0.3))
    at = ((-5, -5, 0.4), (-5, -5.9, 0), (-5, -4.1, 0), (-5.3, -5.2, 1.2), (-3, -5, 1.6))
    draft.join("machine", *(box(size) + place for size, place in zip(hull, at, strict=True)))
    return draft.seen()


def street(seed: int, scenes: ModuleType) -> DrawnSite:
    """Return a street: facades, kerbs, two cars, a person, a lamp and no stone."""
    rng = np.random.default_rng(seed)
    draft = SiteDraft(scenes, rng, Terrain())
    for side in (-1, 1):
        draft.join("facade", box((18, 3, 7)) + [0, side * 8.2, 0])
        draft.join("kerb", box((18, 2.4, 0.12)) + [0, side * 5.5, -0.001])
        x = side * rng.uniform(2.5, 4.5)
        body, cabin = box((4.2, 1.8, 0.75)), box((2.2, 1.6, 0.6))
        draft.join("car", body + [x, side * 3, 0.25], cabin + [x - 0.2, side * 3, 1.0])
    draft.join("person", box((0.45, 0.3, 1.75)) + [rng.uniform(-1, 1), 0, 0])
    draft.join("lamp", box((0.14, 0.14, 6)) + [rng.uniform(-1, 1), 4.6, 0])
    return draft.seen()


def _stones(site: DrawnSite, found: Segmentation) -> Counter[str]:
    """Count the stones, those that one segment covers, the segments, and those that are none."""
    shares = overlaps(site, [one.points for one in found.segments])
    return Counter(
        stones=len(site.things),
        seen=int((shares.max(axis=0, initial=0) >= COVERED).sum()),
        segments=len(shares),
        false=int((shares.max(axis=1, initial=0) < COVERED).sum()),
    )


def overlaps(site: DrawnSite, segments: Sequence[Float]) -> Float:
    """Return the intersection over union of segments and things, shape (segments, things)."""
    count, tree = len(site.things) + 1, cKDTree(site.points)
    sizes, table = np.bincount(site.labels, minlength=count), np.zeros((len(segments), count - 1))
    for row, segment in enumerate(segments):
        common = np.bincount(site.labels[tree.query(segment)[1]], minlength=count)
        table[row] = (common / np.maximum(sizes + len(segment) - common, 1))[1:]
    return table


def _others(plugin: GroundAndClusters, seeds: list[int], scenes: ModuleType) -> list[Figure]:
    """Count what yards and streets are taken for."""
    tally, taken = Counter[str](), Counter[str]()
    for seed in seeds:
        for site in (yard(seed, scenes), street(seed, scenes)):
            found = plugin.segment(Cloud("map", site.points))
            told = len(found.ground) + found.scattered_points
            told += sum(len(one.points) for one in found.segments)
            told += sum(one.points for one in found.left_out)
            tally["points"] += len(site.points)
            tally["told"] += told
            owners = _owners(site, found)
            taken.update(owners)
            shares = overlaps(site, [one.points for one in found.segments])
            is_stone = np.array([thing.endswith("stone") for thing in site.things])
            tally["stones"] += int(is_stone.sum())
            tally["seen"] += int((shares.max(axis=0, initial=0)[is_stone] >= COVERED).sum())
            tally["segments"] += len(owners)
    wrong = sum(taken[name] for name in WRONG)
    machine = taken["machine"]
    share = 100 * wrong / max(tally["segments"], 1)
    seen = 100 * tally["seen"] / max(tally["stones"], 1)
    return [
        held("points with a class [%]", 100 * tally["told"] / tally["points"], CLASSED),
        held(
            "stones of a yard, two of six joined [%]",
            seen,
            KEPT,
            f"{tally['seen']} of {tally['stones']}",
        ),
        held(
            "segments of walls, boulders, people, cars, facades [%]",
            share,
            FALSE,
            f"{wrong} of {tally['segments']}: {dict(taken)}",
        ),
        Figure("segments of a machine", f"{machine} in {len(seeds)} yards"),
    ]


def _owners(site: DrawnSite, found: Segmentation) -> list[str]:
    """Return what most points of each segment are of."""
    tree, names = cKDTree(site.points), ("ground", *site.things)
    counts = (np.bincount(site.labels[tree.query(s.points)[1]]) for s in found.segments)
    return [names[int(np.argmax(count))] for count in counts]
