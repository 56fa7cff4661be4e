"""Lay maps over the map that true poses would have made, and print how far they are off and what they cost.

    OMP_NUM_THREADS=1 python tests/benchmarks/mapping.py swing 1 2 3 4 5
    OMP_NUM_THREADS=1 python tests/benchmarks/mapping.py relocate 1

`swing`: one swing of 20 s; what the sensors said is fed to each estimator with each mapper, as it is, with noisier
satellites, and with none after the first seconds. `relocate`: the whole mission, whose observations are handed to all
of them while it runs. Drift is the mean displacement of a map's points under the rigid motion that lays the map on one
of the same scans with true poses. Milliseconds are processor time.
"""

import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import small_gicp

from executive import registry
from executive.geometry.geodesy import enu_from_geodetic, geodetic_from_enu
from executive.geometry.pose import interpolate, transform
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.mission.run import Options, Run
from executive.mission.streams import Streams
from executive.tree.load import load_mission
from robot_models.machine import load_machine

MACHINE = load_machine("m545")
LIDARS = tuple(sensor.name for sensor in MACHINE.sensors_of("lidar"))
DATUM = np.array([47.4084, 8.5106, 440.0])
ESTIMATORS = ("gnss_imu_filter", "dual_graph")
MAPPERS = ("voxel_map", "pose_graph")
SWING = """
api: 1
mission: swing
extends: base
trees:
  main:
    sequence:
      - run: Localise
        timeout: 30 s
      - run: ScanSwing
        with: {angle: 120 deg, duration: 20 s}
"""
OUTAGE_AFTER_S = 3.0  # of scanning

Ticks = list[Sequence[Any]]
Track = list[tuple[float, np.ndarray]]


class TrueState:
    """An estimator that is told where the cabin is; it exists in this file only."""

    def __init__(self) -> None:
        self.track: list[tuple[float, np.ndarray]] = []
        self._stamp_s = -1.0

    def add_joints(self, sample: Any) -> None:
        self._stamp_s = sample.stamp_s

    def _nothing(self, sample: Any) -> None: ...

    add_imu = add_gnss = add_odometry = _nothing

    def account(self) -> tuple[()]:
        return ()

    def state(self) -> BaseState:
        stamps = [stamp for stamp, _ in self.track]
        i = int(np.clip(np.searchsorted(stamps, self._stamp_s), 1, len(stamps) - 1)) if len(stamps) > 1 else 0
        if i == 0:
            return _state(self._stamp_s, np.eye(4), "INITIALISING")
        (a, T_a), (b, T_b) = self.track[i - 1 : i + 1]
        return _state(self._stamp_s, interpolate(T_a, T_b, float(np.clip((self._stamp_s - a) / (b - a), 0, 1))), "TRUE")


def _state(stamp_s: float, T: np.ndarray, status: str) -> BaseState:
    return BaseState(stamp_s, T, T, T, np.zeros(3), np.zeros(3), 1e-8 * np.eye(6), status)


class Fan:
    """Hands every call on to several mappers, and times their scan pairs."""

    def __init__(self, mappers: dict[str, Any]) -> None:
        self.mappers = mappers
        self.pair_ms: dict[str, list[float]] = {name: [] for name in mappers}

    def add_scan_pair(self, scans: Any, motion: Any) -> int:
        for name, mapper in self.mappers.items():
            before_s = time.process_time()
            kept = mapper.add_scan_pair(scans, motion)
            self.pair_ms[name].append(1e3 * (time.process_time() - before_s))
        return kept

    def __getattr__(self, verb: str) -> Callable[..., Any]:
        return lambda *args: next(iter([getattr(m, verb)(*args) for m in self.mappers.values()]))


@dataclass(slots=True)
class Trial:
    """One estimator with all mappers on a stream of observations, perhaps made worse."""

    name: str
    estimator: Any
    fan: Fan
    streams: Streams
    worsen: Callable[[Iterable[Any]], Iterator[Any]]

    def process(self, observations: Sequence[Any]) -> None:
        self.streams.process(list(self.worsen(observations)))


def _plugin(capability: str, name: str, **services: Any) -> Any:
    plugin = registry.load(capability, name)
    made = plugin(plugin.Settings(), *(services[given] for given in registry.dependencies_of(plugin)))
    made.start()
    return made


def _trial(name: str, estimator: Any, mappers: Iterable[str], worsen: Callable) -> Trial:
    fan = Fan({mapper: _plugin("mapping", mapper, machine=MACHINE) for mapper in mappers})
    streams = Streams({"estimation": estimator, "mapping": fan}, LIDARS, lambda verdict: None)
    return Trial(name, estimator, fan, streams, worsen)


def as_it_is(observations: Iterable[Any]) -> Iterator[Any]:
    yield from observations


def noisier(factor: float, after_s: float, seed: int) -> Callable[[Iterable[Any]], Iterator[Any]]:
    """Make satellites noisier by a factor after a time, and say so in their covariance."""
    rng = np.random.default_rng(seed)

    def worsen(observations: Iterable[Any]) -> Iterator[Any]:
        for one in observations:
            if isinstance(one, GnssFix) and one.stamp_s > after_s:
                more = (factor**2 - 1) * one.covariance_enu_m2
                enu = enu_from_geodetic(one.geodetic, DATUM) + rng.multivariate_normal(np.zeros(3), more)
                covariance = factor**2 * one.covariance_enu_m2
                yield replace(one, geodetic=geodetic_from_enu(enu, DATUM), covariance_enu_m2=covariance)
            else:
                yield one

    return worsen


def silent_while(is_out: Callable[[float], bool]) -> Callable[[Iterable[Any]], Iterator[Any]]:
    """Leave out the fixes of some times."""

    def worsen(observations: Iterable[Any]) -> Iterator[Any]:
        yield from (one for one in observations if not (isinstance(one, GnssFix) and is_out(one.stamp_s)))

    return worsen


def trials(seed: int, first_scan_s: float, is_out: Callable[[float], bool]) -> list[Trial]:
    conditions: dict[str, Callable[[], Callable]] = {
        "": lambda: as_it_is,
        ", GNSS noise x5": lambda: noisier(5.0, first_scan_s, seed),
        ", outage": lambda: silent_while(is_out),
    }
    return [
        _trial(name + words, _plugin("estimation", name, machine=MACHINE), MAPPERS, worsen())
        for words, worsen in conditions.items()
        for name in ESTIMATORS
    ]


def displacement_m(cloud: np.ndarray, true: np.ndarray) -> float:
    """Return how far a map lies from the true one: the mean way of its points under the best rigid motion."""
    clouds = [small_gicp.preprocess_points(points, 0.06, 20, 1) for points in (true, cloud)]
    (target, tree), (source, _) = clouds
    guess = np.eye(4)
    for reach_m in (0.5, 0.15):
        result = small_gicp.align(
            target, source, tree, guess, max_correspondence_distance=reach_m, num_threads=1, max_iterations=60
        )
        guess = result.T_target_source
    return float(np.linalg.norm(transform(guess, cloud) - cloud, axis=1).mean())


class Tap:
    """A run whose observations and true poses are handed on, tick by tick, and whose mapper has company."""

    def __init__(self, mission: str, seed: int, folder: Path, on_tick: Callable[[Sequence[Any]], None]) -> None:
        self.run = Run(load_mission(mission), Options(seed=seed, run_dir=folder))
        self.truth = TrueState()
        self.plugins: dict[str, Any] = self.run._assembly.plugins  # type: ignore[assignment]
        robot = self.plugins["robot"]
        read = robot.read

        def tapped(until_s: float) -> Sequence[Any]:
            observations = read(until_s)
            self.truth.track.append((robot.world.time_s, robot.world.T_world_body("cabin")))
            del self.truth.track[:-60]
            on_tick(observations)
            return observations

        robot.read = tapped


def recorded(seed: int) -> tuple[Ticks, Track]:
    """Return what the sensors said during one swing, tick by tick, and where the cabin truly was."""
    ticks: Ticks = []
    track: Track = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "swing.yaml"
        path.write_text(SWING)

        def keep(observations: Sequence[Any]) -> None:
            ticks.append(observations)
            track.append(tap.truth.track[-1])

        tap = Tap(str(path), seed, Path(folder) / "run", keep)
        tap.run.execute(lambda mission: None)
    return ticks, track


def replayed(ticks: Ticks, track: Track, seed: int) -> tuple[list[Trial], Trial]:
    """Feed a swing to all trials; return them, and the one with true poses."""
    first_scan_s = next(one.stamp_s for tick in ticks for one in tick if hasattr(one, "points_lidar"))
    truth = TrueState()
    true = _trial("truth", truth, ["voxel_map"], as_it_is)
    everyone = trials(seed, first_scan_s, lambda stamp_s: stamp_s > first_scan_s + OUTAGE_AFTER_S)
    for tick, at in zip(ticks, track, strict=True):
        truth.track = [*truth.track[-60:], at]
        for trial in (true, *everyone):
            trial.process(tick)
    return everyone, true


def relocate(seed: int) -> tuple[list[Trial], Trial, dict[str, Any]]:
    """Run the mission; all trials see what it sees, and forget and put back what it does."""
    scanned: dict[str, float] = {}

    def is_out(stamp_s: float) -> bool:  # half of each minute
        return stamp_s > 60.0 and stamp_s % 60.0 > 30.0

    with tempfile.TemporaryDirectory() as folder:
        everyone: list[Trial] = []

        def hand_on(observations: Sequence[Any]) -> None:
            for trial in everyone:
                trial.process(observations)

        tap = Tap("relocate", seed, Path(folder) / "run", hand_on)
        true = _trial("truth", tap.truth, ["voxel_map"], as_it_is)
        everyone += [true, *trials(seed, 10.0, is_out)]
        own = tap.plugins["mapping"]
        tap.plugins["mapping"] = Company(own, [trial.fan for trial in everyone])
        scanned = tap.run.execute(lambda mission: None).report
    return everyone[1:], true, scanned


class Company:
    """The mission's own mapper, whose removals and additions others are told of."""

    def __init__(self, own: Any, others: Sequence[Fan]) -> None:
        self._own, self._others = own, others

    def __getattr__(self, verb: str) -> Any:
        def call(*args: Any) -> Any:
            if verb in ("remove_sphere", "mask_held", "add_surface"):
                for other in self._others:
                    getattr(other, verb)(*args)
            return getattr(self._own, verb)(*args)

        return call


def table(rows: dict[tuple[str, str], list[tuple[float, float, float]]]) -> str:
    lines = [f"{'estimator':34}{'mapper':12}{'drift [mm]':>12}{'worst':>8}{'pair [ms]':>11}{'p95':>8}{'n':>4}"]
    for (estimator, mapper), values in rows.items():
        drift, middle, late = np.array(values).T
        lines.append(
            f"{estimator:34}{mapper:12}{1e3 * np.median(drift):12.1f}{1e3 * drift.max():8.1f}"
            f"{np.median(middle):11.1f}{np.median(late):8.1f}{len(values):4d}"
        )
    return "\n".join(lines)


def measured(everyone: Sequence[Trial], true: Trial) -> Iterator[tuple[tuple[str, str], tuple[float, float, float]]]:
    target = true.fan.cloud().points
    for trial in everyone:
        for name, mapper in trial.fan.mappers.items():
            spent = trial.fan.pair_ms[name]
            drift_m = displacement_m(mapper.cloud().points, target)
            yield (trial.name, name), (drift_m, float(np.median(spent)), float(np.percentile(spent, 95)))
            mapper.close()


def main(what: str, seeds: list[int]) -> None:
    rows: dict[tuple[str, str], list[tuple[float, float, float]]] = {}
    for seed in seeds:
        if what == "swing":
            everyone, true = replayed(*recorded(seed), seed)
        else:
            everyone, true, report = relocate(seed)
            print(f"seed {seed}: {report['outcome']}, {report['ended_s']:.0f} s, {report['counts']}", flush=True)
        for key, values in measured(everyone, true):
            rows.setdefault(key, []).append(values)
        print(f"after seed {seed}\n{table(rows)}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1], [int(word) for word in sys.argv[2:]] or [1])
