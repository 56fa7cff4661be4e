"""Maps beside the map that true poses would have made of the same scans."""

import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from bounds import Bound, Figure, held

from executive.mission.options import Options
from executive.mission.run import Run
from executive.tree.load import load_mission
from trials.mapping_trials import (
    MACHINE,
    Fan,
    Trial,
    TrueState,
    as_it_is,
    displacement_m,
    plugin,
    trial,
    trials,
)

SWING = Path(__file__).with_name("one_swing.yaml")
OUTAGE_AFTER_S = 3.0  # of scanning

DRIFT_MM = {"swing": Bound(10.0), "relocate": Bound(20.0)}
PAIR_MS = Bound(60.0, 30.0)

Rows = dict[tuple[str, str], list[tuple[float, float, float]]]
Ticks = list[Sequence[Any]]
Track = list[tuple[float, np.ndarray]]


class Tap:
    """A run that forwards its observations and true poses tick by tick, with other mappers beside
    its own.
    """

    def __init__(
        self,
        mission: str,
        seed: int,
        folder: Path,
        on_tick: Callable[[Sequence[Any]], None],
        overrides: Sequence[str] = (),
    ) -> None:
        self.run = Run(load_mission(mission, overrides), Options(seed=seed, run_dir=folder))
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
    """Return the observations of one swing, tick by tick, and the true poses of the cabin."""
    ticks: Ticks = []
    track: Track = []
    with tempfile.TemporaryDirectory() as folder:

        def keep(observations: Sequence[Any]) -> None:
            ticks.append(observations)
            track.append(tap.truth.track[-1])

        tap = Tap(str(SWING), seed, Path(folder) / "run", keep)
        tap.run.execute(lambda mission: None)
    return ticks, track


def replayed(ticks: Ticks, track: Track, seed: int) -> tuple[list[Trial], Trial]:
    """Feed a swing to all trials; return them, and the one with true poses."""
    first_scan_s = next(
        one.stamp_s for tick in ticks for one in tick if hasattr(one, "points_lidar")
    )
    truth = TrueState()
    true = trial("truth", truth, ["voxel_map"], as_it_is)
    everyone = trials(seed, first_scan_s, lambda stamp_s: stamp_s > first_scan_s + OUTAGE_AFTER_S)
    for tick, at in zip(ticks, track, strict=True):
        truth.track = [*truth.track[-60:], at]
        for one in (true, *everyone):
            one.process(tick)
    return everyone, true


def relocate(seed: int) -> tuple[dict[str, Any], dict[str, float]]:
    """Run the mission on the pose graph; the other mapper and the true one see, forget and put back
    what it does. Return the report and the largest drifts [mm].
    """
    largest: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as scratch:
        others: list[Trial] = []

        def hand_on(observations: Sequence[Any]) -> None:
            for other in others:
                other.process(observations)
            count = sum(entry.kind == "released" for entry in tap.run._setup.journal.entries)
            if count >= told[-1] + 7:
                told.append(count)
                tell(count)

        def tell(count: int) -> None:
            target = others[0].fan.cloud().points
            mappers = {"pose_graph": own, **others[1].fan.mappers}
            drifts = {
                name: 1e3 * displacement_m(one.cloud().points, target)
                for name, one in mappers.items()
            }
            print(f"{count} relocations, drift [mm]: {drifts}", flush=True)
            largest.update({n: max(drift, largest.get(n, 0.0)) for n, drift in drifts.items()})

        told = [0]
        folder = Path(scratch) / str(seed)
        tap = Tap("relocate", seed, folder, hand_on, ["mapping.plugin=pose_graph"])
        own = tap.plugins["mapping"]
        voxels = trial(
            "", plugin("estimation", "gnss_imu_filter", machine=MACHINE), ["voxel_map"], as_it_is
        )
        others += [trial("truth", tap.truth, ["voxel_map"], as_it_is), voxels]
        tap.plugins["mapping"] = Company(own, [other.fan for other in others])
        close, own.close = (
            own.close,
            lambda: None,
        )  # its last map is read once more after the mission
        report = tap.run.execute(lambda mission: None).report
        tell(sum(pick.placed for pick in report.picks))
        close()
    return report, largest


class Company:
    """The mission's own mapper; removals and additions are forwarded to the others."""

    takes = ()  # no observation beyond the scan pairs

    def __init__(self, own: Any, others: Sequence[Fan]) -> None:
        self._own, self._others = own, others

    def __getattr__(self, verb: str) -> Any:
        def call(*args: Any) -> Any:
            if verb in ("remove_sphere", "mask_held", "add_surface"):
                for other in self._others:
                    getattr(other, verb)(*args)
            return getattr(self._own, verb)(*args)

        return call


def table(rows: Rows) -> str:
    lines = [
        f"{'estimator':34}{'mapper':12}{'drift [mm]':>12}{'worst':>8}{'pair [ms]':>11}"
        f"{'p95':>8}{'n':>4}"
    ]
    for (estimator, mapper), values in rows.items():
        drift, middle, late = np.array(values).T
        lines.append(
            f"{estimator:34}{mapper:12}{1e3 * np.median(drift):12.1f}{1e3 * drift.max():8.1f}"
            f"{np.median(middle):11.1f}{np.median(late):8.1f}{len(values):4d}"
        )
    return "\n".join(lines)


def measured(
    everyone: Sequence[Trial], true: Trial
) -> Iterator[tuple[tuple[str, str], tuple[float, float, float]]]:
    target = true.fan.cloud().points
    for one in everyone:
        for name, mapper in one.fan.mappers.items():
            spent = one.fan.pair_ms[name]
            drift_m = displacement_m(mapper.cloud().points, target)
            yield (
                (one.name, name),
                (drift_m, float(np.median(spent)), float(np.percentile(spent, 95))),
            )
            mapper.close()


def swings(seeds: Sequence[int]) -> list[Figure]:
    """Measure one swing a seed, and hold the maps of undegraded measurements against the bounds."""
    rows: Rows = {}
    for seed in seeds:
        for key, values in measured(*replayed(*recorded(seed), seed)):
            rows.setdefault(key, []).append(values)
        print(f"after seed {seed}\n{table(rows)}", flush=True)
    found = []
    for (estimator, mapper), values in rows.items():
        drift_m, _, late_ms = np.array(values).max(axis=0)
        whose = f"{mapper} with {estimator}"
        if "," not in estimator:  # conditions that make measurements worse have no bound
            found.append(held(f"{whose}: drift, worst [mm]", 1e3 * drift_m, DRIFT_MM["swing"]))
        found.append(held(f"{whose}: scan pair, p95, worst [ms]", late_ms, PAIR_MS))
    return found


def relocations(seeds: Sequence[int]) -> list[Figure]:
    """Run the whole mission a seed, and hold the drifts against the bounds."""
    found = []
    for seed in seeds:
        report, drifts = relocate(seed)
        spent = report.timings_ms["mapping.add_scan_pair"]
        print(
            f"seed {seed}: {report.outcome}, {report.ended_s:.0f} s, {report.counts}, {spent}",
            flush=True,
        )
        for name, drift_mm in drifts.items():
            found.append(
                held(f"{name}, seed {seed}: largest drift [mm]", drift_mm, DRIFT_MM["relocate"])
            )
    return found
