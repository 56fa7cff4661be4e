"""Registration tried on drawn scenes, and the answer of each trial. Nothing has been tuned on the
seeds drawn here.
"""

import os
import subprocess
import sys
import time
from typing import Any

import numpy as np
from executive_plugins.alignment.gicp import Gicp
from executive_plugins.alignment.settings import GicpSettings
from executive_plugins.registration import stopwatch
from executive_plugins.segmentation.ground_and_clusters import GroundAndClusters
from executive_plugins.segmentation.settings import GroundAndClustersSettings
from perception.decoys import DECOYS
from perception.piles import load_scenes

from executive import registry
from executive.geometry.rotation import angle_between
from executive.messages.cloud import Cloud

METHOD = "segment_shot"
RAYS = {20: 190_000, 10: 95_000}  # by seconds of swinging: 105,000 points are in the map after 20 s
SURVEY_POINTS = 78_000
FIRST_SEED: dict[int | str, int] = {
    20: 11_000,
    10: 12_000,
    "wrong": 13_000,
    "stretched": 14_000,
    "threads": 15_000,
}
STRETCHES = (0.97, 0.98, 1.02, 1.03)
RIGHT_M, RIGHT_RAD = 0.05, np.radians(1.0)
Answers = list[dict[str, Any]]


def registrar(method: str = METHOD) -> Any:
    """Return a started registrar whose stages are timed by processor time, which does not
    depend on other processes.
    """
    stopwatch.wall_s = time.process_time  # type: ignore[assignment]
    plugin = registry.load("registration", method)
    segmentation = GroundAndClusters(GroundAndClustersSettings())
    made = plugin(plugin.Settings(), segmentation, Gicp(GicpSettings()))
    segmentation.start()
    made.start()
    return made


def swings(seconds: int, count: int, method: str = METHOD) -> Answers:
    """Register surveys of seven stones with the maps of swings so long."""
    scenes, ours = load_scenes(), registrar(method)
    first = FIRST_SEED[seconds]
    drawn = (scenes.scene_of(seed, rays=RAYS[seconds]) for seed in range(first, first + count))
    return [tried(ours, scene, _survey(scene)) for scene in drawn]


def stretched(count: int) -> Answers:
    """Register surveys whose scale is wrong by 2 and 3 %."""
    scenes, ours, answers = load_scenes(), registrar(), []
    for stretch in STRETCHES:
        for seed in range(FIRST_SEED["stretched"], FIRST_SEED["stretched"] + count):
            scene = scenes.scene_of(seed, rays=RAYS[20], stretch=stretch)
            answers.append(tried(ours, scene, _survey(scene)))
    return answers


def wrong_sites(count: int) -> dict[str, Answers]:
    """Register surveys that are not of the site, so many of each kind of decoy."""
    scenes, ours = load_scenes(), registrar()
    answers: dict[str, Answers] = {name: [] for name in DECOYS}
    for name, decoy in DECOYS.items():
        for seed in range(FIRST_SEED["wrong"], FIRST_SEED["wrong"] + count):
            target, source = decoy(scenes, seed, RAYS[20 if seed % 2 else 10])
            found = ours.register(target, _thinned(source, seed), np.random.default_rng(0))
            answers[name].append({"accepted": bool(found.accepted), "reason": found.reason})
    return answers


def tried(ours: Any, scene: Any, survey: Cloud) -> dict[str, Any]:
    """Register one scene's survey and compare with what is true of it."""
    found = ours.register(scene.target, survey, np.random.default_rng(0))
    error_m = scene.errors(found.apply)[1]
    error_rad = angle_between(found.T_target_source[:3, :3], scene.T_target_source[:3, :3])
    return {
        "accepted": bool(found.accepted),
        "is_right": bool(found.accepted and error_m < RIGHT_M and error_rad < RIGHT_RAD),
        "error_m": error_m,
        "error_rad": float(error_rad),
        "scale_error": abs(found.scale * scene.stretch - 1),
        "points": [len(scene.target), len(survey)],
        "timings_ms": dict(found.timings_ms),
    }


def segmented(count: int) -> list[float]:
    """Return processor milliseconds to segment one cloud each, maps and surveys of the swings of 20
    s.
    """
    scenes, segmentation = load_scenes(), GroundAndClusters(GroundAndClustersSettings())
    segmentation.start()
    spent_ms = []
    for seed in range(FIRST_SEED[20], FIRST_SEED[20] + count):
        scene = scenes.scene_of(seed, rays=RAYS[20])
        for cloud in (scene.target, _survey(scene)):
            begun_s = time.process_time()
            segmentation.segment(cloud)
            spent_ms.append(1e3 * (time.process_time() - begun_s))
    return spent_ms


def same_bits(count: int) -> dict[str, int]:
    """Return how many scenes give one T, to the last bit, twice over and on one, two and four
    threads.
    """
    told: dict[str, list[str]] = {}
    for name, threads in {"1": 1, "1 again": 1, "2": 2, "4": 4}.items():
        environment = os.environ | {
            f"{library}_NUM_THREADS": str(threads) for library in ("OMP", "OPENBLAS", "NUMBA")
        }
        words = [sys.executable, "-c", f"from perception import trials; trials.print_bits({count})"]
        done = subprocess.run(
            words, env=environment, cwd=_BENCHMARKS, capture_output=True, text=True, check=True
        )
        told[name] = done.stdout.split()
    again = sum(a == b for a, b in zip(told["1"], told["1 again"], strict=True))
    threads = sum(a == b == c for a, b, c in zip(told["1"], told["2"], told["4"], strict=True))
    return {"scenes": count, "same_again": again, "same_over_threads": threads}


def print_bits(count: int) -> None:
    """Print the bytes of T of so many scenes, a word each."""
    scenes, ours = load_scenes(), registrar()
    for seed in range(FIRST_SEED["threads"], FIRST_SEED["threads"] + count):
        scene = scenes.scene_of(seed, rays=RAYS[10])
        found = ours.register(scene.target, scene.source, np.random.default_rng(0))
        print((found.T_target_source * found.scale).tobytes().hex())


def _survey(scene: Any) -> Cloud:
    return _thinned(scene.source, len(scene.target))


def _thinned(survey: Cloud, seed: int) -> Cloud:
    """Leave as many points as are asked for."""
    kept = np.random.default_rng(seed).permutation(len(survey))[:SURVEY_POINTS]
    return Cloud(survey.frame, survey.points[np.sort(kept)])


_BENCHMARKS = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
