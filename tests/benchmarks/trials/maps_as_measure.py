"""The site's map with each estimator's poses through an outage of the satellites.

The cabin swings for 20 s with the lidars on; three seconds into that the satellites are lost for
good. One run is recorded and replayed for each estimator, and once with true poses, which shows
what mapper and lidar cost.
"""

import itertools
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import open3d as o3d
from bounds import Bound, Figure, held
from matplotlib import figure as plots

from executive.estimate.drop import Drop
from executive.interfaces.estimation import Estimator
from executive.interfaces.odometry import LidarOdometry
from executive.logs.log import Arrival, Log
from executive.logs.topics import Topics
from executive.machine.machine import load_machine
from executive.messages.base_state import BaseState
from executive.messages.lidar import LidarScan
from executive.mission.run import Options, Run
from executive.mission.streams import Streams
from executive.tree.load import load_mission
from trials.mapping_trials import Unheard, plugin

ESTIMATORS = ("dual_graph", "error_state_ekf", "gnss_imu_filter")
SWING = Path(__file__).with_name("one_swing.yaml")
BEFORE_OUTAGE_S = 3.0
UNWATCHED = "imu_base:0:9999"  # without its inertial sensor nothing tells that the chassis stands
SHOWN_M = 0.3  # distance at the end of the colour scale
HELD = "dual_graph"  # the bound is for this estimator; the others stand beside it
NEAR_MM = Bound(10.0)  # a map is off by 1 cm at most after a swing of 20 s
HEADER = (
    "| seed | condition | poses | median [mm] | 95 % [mm] | points |\n|---|---|---|---|---|---|"
)

Maps = dict[str, dict[str, np.ndarray]]  # condition → whose poses → points [m], shape (N, 3)


class TruePoses(Estimator):
    """An estimator that reports the true pose of the cabin; only this benchmark uses it."""

    def __init__(self, truth: Any) -> None:
        self._truth, self._stamp_s = truth, -1.0

    def add_joints(self, sample: Any) -> None:
        self._stamp_s = sample.stamp_s

    def _nothing(self, sample: Any) -> None: ...

    add_imu = add_gnss = add_odometry = _nothing

    def state(self) -> BaseState:
        is_known = self._stamp_s > 0
        T = self._truth.T_world_cabin(self._stamp_s) if is_known else np.eye(4)
        status = "TRUE" if is_known else "INITIALISING"
        return BaseState(self._stamp_s, T, T, T, np.zeros(3), np.zeros(3), 1e-8 * np.eye(6), status)


class Remembering(LidarOdometry):
    """An odometry that matches each scan once and keeps the answer for the next estimator."""

    def __init__(self, odometry: LidarOdometry) -> None:
        self._odometry, self._answers = odometry, {}
        self.add_imu, self.add_joints = odometry.add_imu, odometry.add_joints

    def add_scan(self, scan: LidarScan) -> Any:
        key = (scan.frame, scan.stamp_s)
        if key not in self._answers:
            self._answers[key] = self._odometry.add_scan(scan)
        return self._answers[key]


class Surface:
    """The true surface of a site at rest."""

    def __init__(self, site: Any) -> None:
        self._scene = o3d.t.geometry.RaycastingScene(1)
        meshes = [site.terrain.mesh()]
        for stone, T in zip(site.stones, site.T_world_stones, strict=True):
            meshes.append((stone.vertices @ T[:3, :3].T + T[:3, 3], stone.triangles))
        for vertices, triangles in meshes:
            self._scene.add_triangles(vertices.astype(np.float32), triangles.astype(np.uint32))

    def distances_m(self, points: np.ndarray) -> np.ndarray:
        return self._scene.compute_distance(points.astype(np.float32), 1).numpy()


def recorded(seed: int, folder: Path) -> tuple[Path, Any, Surface]:
    """Swing once, and return the log, the cabin's true poses, and the true surface."""
    robots: list[Any] = []
    options = Options(seed=seed, run_dir=folder / "run", record_log=folder / "swing.mcap")

    def watch(mission: Any) -> None:
        if not robots:
            robot = mission.services.plugins["robot"]
            robots.extend([robot.truth_log, Surface(robot.world.site)])

    Run(load_mission(str(SWING)), options).execute(watch)
    return folder / "swing.mcap", *robots


def ticks(log: Path, drops: Sequence[Drop]) -> Iterator[list[Any]]:
    """Yield what arrived together, without what is dropped."""
    arrivals: Iterable[Arrival] = Log(log, Topics()).arrivals()
    for _, together in itertools.groupby(arrivals, key=lambda arrival: arrival.arrival_s):
        yield [
            a.observation for a in together if not any(drop.takes(a.observation) for drop in drops)
        ]


def mapped(
    log: Path, estimator: Estimator, odometry: LidarOdometry, drops: Sequence[Drop]
) -> np.ndarray:
    """Return the points of the map that an estimator's poses make (N, 3)."""
    machine = load_machine("m545")
    lidars = [sensor.name for sensor in machine.sensors_of("lidar")]
    mapper = plugin("mapping", "voxel_map", machine=machine)
    plugins = {"estimation": estimator, "odometry": odometry, "mapping": mapper}
    streams = Streams(plugins, lidars, Unheard())
    for observations in ticks(log, drops):
        streams.process(observations)
    points = np.array(mapper.cloud().points)
    estimator.close()
    mapper.close()
    return points


def first_scan_s(log: Path) -> float:
    return next(o.stamp_s for tick in ticks(log, ()) for o in tick if isinstance(o, LidarScan))


def picture(path: Path, maps: Maps, surface: Surface) -> None:
    figure = plots.Figure(figsize=(13, 7), layout="constrained")
    rows = figure.subplots(len(maps), len(ESTIMATORS) + 1, sharex=True, sharey=True)
    for row, (condition, clouds) in zip(rows, maps.items(), strict=True):
        for axes, (name, points) in zip(row, clouds.items(), strict=True):
            distance = surface.distances_m(points)
            order = np.argsort(distance)
            shown = axes.scatter(
                *points[order, :2].T,
                c=distance[order],
                s=0.2,
                cmap="turbo",
                vmin=0,
                vmax=SHOWN_M,
                linewidths=0,
            )
            axes.set(title=f"{name}\nmedian {1e3 * np.median(distance):.0f} mm", aspect="equal")
        row[0].set(ylabel=condition)
    figure.colorbar(shown, ax=rows, label="distance to the true surface [m]", shrink=0.6)
    figure.savefig(path, dpi=100)


def measured(seed: int, folder: Path) -> tuple[Maps, Surface]:
    """Return the maps of one seed by condition and estimator,
    and what they are measured against.
    """
    log, truth, surface = recorded(seed, folder)
    outage = Drop("gnss", first_scan_s(log) + BEFORE_OUTAGE_S, np.inf)
    machine = load_machine("m545")
    odometry = Remembering(plugin("odometry", "scan_to_submap", machine=machine))
    conditions = {"chassis watched": [outage], "chassis unwatched": [outage, Drop.parse(UNWATCHED)]}
    true_map = mapped(log, TruePoses(truth), odometry, ())
    maps: Maps = {}
    for condition, drops in conditions.items():
        maps[condition] = {"true poses": true_map}
        for name in ESTIMATORS:
            maps[condition][name] = mapped(
                log, plugin("estimation", name, machine=machine), odometry, drops
            )
            distance = surface.distances_m(maps[condition][name])
            print(line(seed, condition, name, distance), flush=True)
    print(line(seed, "", "true poses", surface.distances_m(true_map)), flush=True)
    return maps, surface


def line(seed: int, condition: str, name: str, distance_m: np.ndarray) -> str:
    median, p95 = 1e3 * np.percentile(distance_m, [50, 95])
    return f"| {seed} | {condition} | {name} | {median:.0f} | {p95:.0f} | {len(distance_m)} |"


def figures(seed: int, maps: Maps, surface: Surface) -> Iterator[Figure]:
    """Yield the distance of the map to the true surface under each condition."""
    for condition, clouds in maps.items():
        for name in ("true poses", HELD):
            median_mm = 1e3 * float(np.median(surface.distances_m(clouds[name])))
            yield held(
                f"{name}, {condition}, seed {seed}: distance, median [mm]", median_mm, NEAR_MM
            )
