"""Estimators and mappers side by side on one stream of observations, original or degraded, and how
far maps are off.
"""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import small_gicp

from executive import registry
from executive.geometry.geodesy import enu_from_geodetic, geodetic_from_enu
from executive.geometry.pose import interpolate, transform
from executive.machine.machine import load_machine
from executive.messages.base_state import BaseState
from executive.messages.gnss import GnssFix
from executive.mission.streams import StreamListener, Streams

MACHINE = load_machine("m545")
LIDARS = tuple(sensor.name for sensor in MACHINE.sensors_of("lidar"))
DATUM = np.array([47.4084, 8.5106, 440.0])
ESTIMATORS = ("gnss_imu_filter", "dual_graph")
MAPPERS = ("voxel_map", "pose_graph")


class Unheard(StreamListener):
    """Ignore verdicts and changes of status; an error of a plugin ends the benchmark."""

    def _nothing(self, value: Any) -> None: ...

    take_verdict = take_status = take_unknown = _nothing

    def take_error(self, capability: str, plugin: Any, error: Exception) -> None:
        raise error


class TrueState:
    """An estimator that reports the true pose of the cabin; only this benchmark uses it."""

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
        i = (
            int(np.clip(np.searchsorted(stamps, self._stamp_s), 1, len(stamps) - 1))
            if len(stamps) > 1
            else 0
        )
        if i == 0:
            return _state(self._stamp_s, np.eye(4), "INITIALISING")
        (a, T_a), (b, T_b) = self.track[i - 1 : i + 1]
        return _state(
            self._stamp_s,
            interpolate(T_a, T_b, float(np.clip((self._stamp_s - a) / (b - a), 0, 1))),
            "TRUE",
        )


def _state(stamp_s: float, T: np.ndarray, status: str) -> BaseState:
    return BaseState(stamp_s, T, T, T, np.zeros(3), np.zeros(3), 1e-8 * np.eye(6), status)


class Fan:
    """Forward every call to several mappers, and time their scan pairs."""

    takes = ()  # no observation beyond the scan pairs

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
    """One estimator with all mappers on a stream of observations, original or degraded."""

    name: str
    estimator: Any
    fan: Fan
    streams: Streams
    worsen: Callable[[Iterable[Any]], Iterator[Any]]

    def process(self, observations: Sequence[Any]) -> None:
        self.streams.process(list(self.worsen(observations)))


def plugin(capability: str, name: str, **services: Any) -> Any:
    plugin = registry.load(capability, name)
    made = plugin(
        plugin.Settings(), *(services[given] for given in registry.dependencies_of(plugin))
    )
    made.start()
    return made


def trial(name: str, estimator: Any, mappers: Iterable[str], worsen: Callable) -> Trial:
    fan = Fan({mapper: plugin("mapping", mapper, machine=MACHINE) for mapper in mappers})
    streams = Streams({"estimation": estimator, "mapping": fan}, LIDARS, Unheard())
    return Trial(name, estimator, fan, streams, worsen)


def as_it_is(observations: Iterable[Any]) -> Iterator[Any]:
    yield from observations


def noisier(factor: float, after_s: float, seed: int) -> Callable[[Iterable[Any]], Iterator[Any]]:
    """Multiply the noise of fixes after a time, and state it in their covariance."""
    rng = np.random.default_rng(seed)

    def worsen(observations: Iterable[Any]) -> Iterator[Any]:
        for one in observations:
            if isinstance(one, GnssFix) and one.stamp_s > after_s:
                more = (factor**2 - 1) * one.covariance_enu_m2
                enu = enu_from_geodetic(one.geodetic, DATUM) + rng.multivariate_normal(
                    np.zeros(3), more
                )
                covariance = factor**2 * one.covariance_enu_m2
                yield replace(
                    one, geodetic=geodetic_from_enu(enu, DATUM), covariance_enu_m2=covariance
                )
            else:
                yield one

    return worsen


def silent_while(is_out: Callable[[float], bool]) -> Callable[[Iterable[Any]], Iterator[Any]]:
    """Leave out the fixes of some intervals."""

    def worsen(observations: Iterable[Any]) -> Iterator[Any]:
        yield from (
            one for one in observations if not (isinstance(one, GnssFix) and is_out(one.stamp_s))
        )

    return worsen


def trials(seed: int, first_scan_s: float, is_out: Callable[[float], bool]) -> list[Trial]:
    conditions: dict[str, Callable[[], Callable]] = {
        "": lambda: as_it_is,
        ", GNSS noise x5": lambda: noisier(5.0, first_scan_s, seed),
        ", outage": lambda: silent_while(is_out),
    }
    return [
        trial(name + words, plugin("estimation", name, machine=MACHINE), MAPPERS, worsen())
        for words, worsen in conditions.items()
        for name in ESTIMATORS
    ]


def displacement_m(cloud: np.ndarray, true: np.ndarray) -> float:
    """Return how far a map lies from the true one: the mean displacement of its points under the
    best rigid motion.
    """
    clouds = [small_gicp.preprocess_points(points, 0.06, 20, 1) for points in (true, cloud)]
    (target, tree), (source, _) = clouds
    guess = np.eye(4)
    for reach_m in (0.5, 0.15):
        result = small_gicp.align(
            target,
            source,
            tree,
            guess,
            max_correspondence_distance=reach_m,
            num_threads=1,
            max_iterations=60,
        )
        guess = result.T_target_source
    return float(np.linalg.norm(transform(guess, cloud) - cloud, axis=1).mean())
