"""Single stones, looked for where they are and where another one is.

A stone's model comes from one swing and a survey; it is tumbled, and looked for in what another
swing shows within 1.8 m of itself and of the next two. An answer is right if it is off by less than
5 cm and 5°, wherever it was looked for: the next stone may be within those 1.8 m.
"""

from collections import Counter

import numpy as np
from bounds import Bound, Figure, held
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings
from perception.piles import load_scenes
from perception.trials import registrar

from executive.arrays import Float
from executive.geometry.pose import pose, transform
from executive.geometry.rotation import angle_between, exp_so3
from executive.geometry.voxels import voxel_means
from executive.messages.cloud import Cloud

RADIUS_M, RIGHT_M, RIGHT_RAD = 1.8, 0.05, np.radians(5)
FIRST_SEED = 9012


def tumbled(rng: np.random.Generator) -> Float:
    """Draw a motion so large that ICP alone does not converge."""
    axis = rng.normal(size=3)
    return pose(exp_so3(axis / np.linalg.norm(axis) * rng.uniform(0.8, 3.1)), rng.uniform(-3, 3, 3))


def counted(sites: int) -> Counter[str]:
    """Return how often each verdict was reached, printed site by site."""
    scenes, ours = load_scenes(), registrar()
    segmentation = GroundAndClusters(GroundAndClustersSettings())
    counts: Counter[str] = Counter()
    for seed in range(FIRST_SEED, FIRST_SEED + sites):
        rng = np.random.default_rng(seed)
        scene, stones = scenes._world(rng, 7, 3.2, 7.5, scenes._stone)
        first = scenes._swept(scene, rng, 120_000)
        anew = scenes._swept(scene, rng, int(rng.choice([60_000, 120_000, 200_000])))
        survey = scenes._surveyed(scene, rng, 120_000, np.array([*stones[:, :2].mean(axis=0), 0.3]))
        models = segmentation.segment(
            Cloud("map", voxel_means(np.vstack([first, survey]), 0.03))
        ).segments
        for i, stone in enumerate(models):
            seen = anew[np.linalg.norm(anew[:, :2] - stone.centroid[:2], axis=1) < RADIUS_M]
            for j in ((i + step) % len(models) for step in range(3)):
                T = tumbled(np.random.default_rng([seed, i, j]))
                found = ours.find(Cloud("map", seen), Cloud("map", transform(T, models[j].points)))
                counts[
                    _verdict(found.T_target_source @ T, models[j].centroid, i == j, found.accepted)
                ] += 1
        print(f"{seed}: {dict(sorted(counts.items()))}", flush=True)
    return counts


def _verdict(left: Float, centroid: Float, is_there: bool, accepted: bool) -> str:
    off_m = np.linalg.norm(transform(left, centroid) - centroid)
    right = bool(off_m < RIGHT_M and angle_between(left[:3, :3], np.eye(3)) < RIGHT_RAD)
    kind = "itself" if is_there else "another, and found beside it" if right else "another"
    return f"{kind}, {'right' if right else 'wrong'}, {'accepted' if accepted else 'refused'}"


def figures(counts: Counter[str]) -> list[Figure]:
    """Hold the answers against the bounds of registration: 95 % right, no wrong one accepted."""
    itself = sum(n for verdict, n in counts.items() if verdict.startswith("itself"))
    wrong = sum(n for verdict, n in counts.items() if verdict.endswith("wrong, accepted"))
    right = counts["itself, right, accepted"]
    return [
        held(
            "share of stones that are found themselves",
            right / itself if itself else float("nan"),
            Bound(0.95, is_least=True),
            f"{right} of {itself}",
        ),
        held("wrong answers accepted", wrong, Bound(0), f"{wrong} of {counts.total()}"),
    ]
