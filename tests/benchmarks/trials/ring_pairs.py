"""What `ring_pairs.py` measures."""

import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypeVar

import numpy as np
import small_gicp
from bounds import Bound, Figure, held
from executive_plugins.alignment.gicp import Gicp
from executive_plugins.alignment.point_to_plane import PointToPlane
from executive_plugins.alignment.settings import GicpSettings, PointToPlaneSettings

from executive.arrays import Float
from executive.clouds.reader import read_cloud
from executive.errors import DataError
from executive.geometry.pose import pose
from executive.geometry.rotation import angle_between, exp_so3
from executive.interfaces.alignment import Aligner
from executive.messages.cloud import Cloud

Answer = TypeVar("Answer")
REACH_M, OFF_M, OFF_RAD = 0.3, 0.10, np.radians(0.3)
RINGS, STEPS, NOISE_M, FARTHEST_M = 32, 2180, 0.015, 70.0
HEIGHT_M = 1.8  # of the lidar above the ground
ACCEPTED, NONE = Bound(1.0, is_least=True), Bound(0)
ERROR_MM, TIMES = Bound(5.0), Bound(1.2)


@dataclass(frozen=True, slots=True, eq=False)
class Pair:
    """Two clouds, the motion between them, and a guess of it."""

    target: Cloud
    source: Cloud
    T: Float
    T_guess: Float


class Yard:
    """Four walls and boxes on level ground, drawn."""

    def __init__(self, rng: np.random.Generator) -> None:
        self._walls_m, self._turn = rng.uniform(8, 40, 4), rng.uniform(0, np.pi)
        self._height_m = rng.uniform(4, 9)
        middles = rng.uniform([-20, -20], [20, 20], (14, 2))
        away = np.hypot(*middles.T) > 6
        sizes, turns = rng.uniform([0.3, 0.3, 0.4], [3, 3, 5], (14, 3)), rng.uniform(0, np.pi, 14)
        self._boxes = list(zip(middles[away], sizes[away], turns[away], strict=True))

    def scan(self, T: Float, rng: np.random.Generator) -> Float:
        """Return the returns of a lidar at a pose, in its frame [m], shape (N, 3)."""
        steep, turn = np.meshgrid(
            np.radians(np.linspace(-25, 15, RINGS)),
            np.linspace(0, 2 * np.pi, STEPS, endpoint=False) + rng.uniform(0, 2 * np.pi / STEPS),
        )
        level = np.cos(steep)
        rays = np.stack([level * np.cos(turn), level * np.sin(turn), np.sin(steep)], axis=-1)
        rays = rays.reshape(-1, 3)
        along, start = rays @ T[:3, :3].T, T[:3, 3]
        range_m = _onto_plane(start, along, np.array([0.0, 0.0, 1.0]), -HEIGHT_M)
        for side, wall_m in enumerate(self._walls_m):
            angle = self._turn + side * np.pi / 2
            hit_m = _onto_plane(start, along, np.array([np.cos(angle), np.sin(angle), 0.0]), wall_m)
            is_low = start[2] + np.where(np.isfinite(hit_m), hit_m, 0) * along[:, 2] < (
                self._height_m - HEIGHT_M
            )
            range_m = np.minimum(range_m, np.where(is_low, hit_m, np.inf))
        for middle, size, angle in self._boxes:
            R = exp_so3(np.array([0.0, 0.0, angle]))
            place = np.append(middle, -HEIGHT_M)
            range_m = np.minimum(range_m, _onto_box((start - place) @ R, along @ R, size))
        seen = range_m < FARTHEST_M
        noisy_m = range_m[seen] + rng.normal(0, NOISE_M, int(seen.sum()))
        return np.asarray(rays[seen] * noisy_m[:, None])


def _onto_plane(start: Float, along: Float, normal: Float, at_m: float) -> Float:
    speed = along @ normal
    hit_m = (at_m - start @ normal) / np.where(np.abs(speed) < 1e-9, 1e-9, speed)
    return np.asarray(np.where(hit_m > 0.5, hit_m, np.inf))


def _onto_box(start: Float, along: Float, size: Float) -> Float:
    safe = np.where(np.abs(along) < 1e-12, 1e-12, along)
    one, other = (-size - start) / safe, (size - start) / safe
    enters = np.minimum(one, other).max(axis=1)
    leaves = np.maximum(one, other).min(axis=1)
    return np.asarray(np.where((enters < leaves) & (enters > 0.5), enters, np.inf))


def _guess(T: Float, rng: np.random.Generator) -> Float:
    axis, side = rng.normal(size=(2, 3))
    axis, side = axis / np.linalg.norm(axis), side / np.linalg.norm(side)
    return np.asarray(T @ pose(exp_so3(OFF_RAD * axis), OFF_M * side))


def drawn_pairs(seeds: Iterable[int]) -> Iterator[Pair]:
    """Draw a yard and two scans of it for each seed."""
    for seed in seeds:
        rng = np.random.default_rng(seed)
        yard = Yard(rng)
        T = pose(exp_so3(rng.normal(0, 0.01, 3)), rng.normal(0, [0.4, 0.4, 0.03]))
        target, source = yard.scan(np.eye(4), rng), yard.scan(T, rng)
        yield Pair(Cloud("target", target), Cloud("source", source), T, _guess(T, rng))


def file_pairs(folder: Path, seeds: Iterable[int]) -> Iterator[Pair]:
    """Draw a guess for each seed between two clouds of a folder.

    Raises:
        DataError: If a file is missing or is no cloud or matrix.
    """
    target, source = (
        Cloud(name, read_cloud(folder / f"{name}.ply").points) for name in ("target", "source")
    )
    path = folder / "T_target_source.txt"
    try:
        T = np.loadtxt(path)
    except (OSError, ValueError) as error:
        raise DataError(f"{path}: no matrix: {error}") from error
    for seed in seeds:
        yield Pair(target, source, T, _guess(T, np.random.default_rng(seed)))


@dataclass(slots=True)
class Tally:
    """What one aligner answered."""

    errors: list[tuple[float, float]] = field(default_factory=list)
    ms: list[float] = field(default_factory=list)
    accepted: int = 0
    others: list[bool] = field(default_factory=list)  # whether another yard's scan was accepted

    def add(self, pair: Pair, found: Float, taken_ms: float) -> None:
        self.errors.append(_error(pair.T, found))
        self.ms.append(taken_ms)

    def words(self) -> str:
        mm, degrees = np.array(self.errors).T
        return (
            f"{np.median(mm):.1f} mm (largest {mm.max():.1f}), {np.median(degrees):.3f}°, "
            f"{np.median(self.ms):.0f} ms"
        )


def figures(what: str, pairs: Iterable[Pair]) -> list[Figure]:
    """Return shares of accepted motions, median errors and times of each plugin."""
    plugins: dict[str, Aligner] = {
        "gicp": Gicp(GicpSettings()),
        "point_to_plane": PointToPlane(PointToPlaneSettings()),
    }
    for plugin in plugins.values():
        plugin.start()
    tallies, beside, before = {name: Tally() for name in plugins}, Tally(), None
    for pair in pairs:
        for name, plugin in plugins.items():
            _try(plugin, tallies[name], pair, before)
        beside.add(pair, *_timed(lambda: _small_gicp(pair)))  # noqa: B023
        before = pair
    told = [Figure(f"{what}: small_gicp", beside.words())]
    for name, tally in tallies.items():
        told += _told(f"{what}: `{name}`", tally, beside)
    return told


def _try(plugin: Aligner, tally: Tally, pair: Pair, before: Pair | None) -> None:
    found, taken_ms = _timed(lambda: plugin.align(pair.target, pair.source, pair.T_guess, REACH_M))
    tally.accepted += found.accepted
    tally.add(pair, found.T_target_source, taken_ms)
    if before is not None and before.source is not pair.source:
        other = plugin.align(pair.target, before.source, pair.T_guess, REACH_M)
        tally.others.append(other.accepted)


def _told(whose: str, tally: Tally, beside: Tally) -> list[Figure]:
    count = len(tally.ms)
    times = float(np.median(np.divide(tally.ms, beside.ms)))
    middle_mm = float(np.median([mm for mm, _ in tally.errors]))
    accepted = f"{tally.accepted} of {count}"
    told = [
        held(f"{whose} accepted", tally.accepted / count, ACCEPTED, accepted),
        held(f"{whose}, error [mm]", middle_mm, ERROR_MM, tally.words()),
        held(f"{whose}, time in that of small_gicp", times, TIMES, f"{times:.2f}"),
    ]
    if tally.others:
        words = f"{sum(tally.others)} of {len(tally.others)}"
        told.append(
            held(f"{whose}, scans of another yard accepted", sum(tally.others), NONE, words)
        )
    return told


def _small_gicp(pair: Pair) -> Float:
    return np.array(
        small_gicp.align(
            pair.target.points,
            pair.source.points,
            pair.T_guess,
            downsampling_resolution=GicpSettings().voxel_m,
            max_correspondence_distance=REACH_M,
            num_threads=1,
        ).T_target_source
    )


def _timed(action: Callable[[], Answer], times: int = 2) -> tuple[Answer, float]:
    """Return the result and the least time of several runs [ms]."""
    taken_ms = []
    for _ in range(times):
        begun_s = time.process_time()
        result = action()
        taken_ms.append(1e3 * (time.process_time() - begun_s))
    return result, min(taken_ms)


def _error(T: Float, found: Float) -> tuple[float, float]:
    """Return the error of the source's origin [mm] and of the rotation [degrees]."""
    return (
        1e3 * float(np.linalg.norm(found[:3, 3] - T[:3, 3])),
        float(np.degrees(angle_between(found[:3, :3], T[:3, :3]))),
    )
