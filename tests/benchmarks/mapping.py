"""Lay maps over the map that true poses would have made, and print how far they are off and what
they cost.

    OMP_NUM_THREADS=1 python tests/benchmarks/mapping.py swing 1 2 3 4 5
    OMP_NUM_THREADS=1 python tests/benchmarks/mapping.py relocate 1
    OMP_NUM_THREADS=1 python tests/benchmarks/mapping.py relocate --keep runs 1     for
    database_poses.py --read runs/1

`swing`: one swing of 20 s; what the sensors said is fed to each estimator with each mapper, as it
is, with noisier satellites, and with none after the first seconds. `relocate`: the whole mission on
the pose graph, with the other mapper beside it; drift is told after each round of seven. Drift is
the mean displacement of a map's points under the rigid motion that lays the map on one of the same
scans with true poses. Milliseconds are processor time, those of the mission wall time.
"""

import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from database_poses import write_truth
from mapping_trials import (
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

from executive.mission.run import Options, Run
from executive.tree.load import load_mission

SWING = Path(__file__).with_name("one_swing.yaml")
OUTAGE_AFTER_S = 3.0  # of scanning

Ticks = list[Sequence[Any]]
Track = list[tuple[float, np.ndarray]]


class Tap:
    """A run whose observations and true poses are handed on, tick by tick, and whose mapper has
    company.
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
    """Return what the sensors said during one swing, tick by tick,
    and where the cabin truly was.
    """
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


def relocate(seed: int, kept: Path | None) -> dict[str, Any]:
    """Run the mission on the pose graph; the other mapper and the true one see, forget and put back
    what it does.
    """
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

        told = [0]
        folder = (kept or Path(scratch)) / str(seed)
        tap = Tap("relocate", seed, folder, hand_on, ["mapping.plugin=pose_graph"])
        own = tap.plugins["mapping"]
        voxels = trial(
            "", plugin("estimation", "gnss_imu_filter", machine=MACHINE), ["voxel_map"], as_it_is
        )
        others += [trial("truth", tap.truth, ["voxel_map"], as_it_is), voxels]
        tap.plugins["mapping"] = Company(own, [other.fan for other in others])
        close, own.close = own.close, lambda: None  # its last map is looked at once more
        report = tap.run.execute(lambda mission: None).report
        tell(sum(pick["placed"] for pick in report["picks"]))
        close()
        write_truth(folder, tap.plugins["robot"].truth_log)
    return report


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


def main(what: str, words: list[str]) -> None:
    kept = Path(words[1]) if words[:1] == ["--keep"] else None
    seeds = [int(word) for word in words[2 if kept else 0 :]] or [1]
    rows: dict[tuple[str, str], list[tuple[float, float, float]]] = {}
    for seed in seeds:
        if what == "swing":
            for key, values in measured(*replayed(*recorded(seed), seed)):
                rows.setdefault(key, []).append(values)
            print(f"after seed {seed}\n{table(rows)}", flush=True)
        else:
            report = relocate(seed, kept)
            spent = report["timings_ms"]["mapping.add_scan_pair"]
            print(
                f"seed {seed}: {report['outcome']}, {report['ended_s']:.0f} s, "
                f"{report['counts']}, {spent}",
                flush=True,
            )


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
