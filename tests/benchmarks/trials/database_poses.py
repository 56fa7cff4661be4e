"""The object database of a `relocate` run against the simulator's truth."""

import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from bounds import Bound, Figure, held, judged

from executive import registry
from executive.geometry.pose import interpolate, inverse
from executive.geometry.rotation import angle_between
from executive.mission.run import Options, Run
from executive.tree.load import load_mission

TRUTH = "truth.npz"
SAME_STONE_M = 0.7
NEAR_CM = NEAR_DEG = Bound(3.0, 1.5)
HEADER = (
    "              n  realigned   settled cm, °   cm: median p90    worst   °: median p90    worst"
)

Entries = list[dict]
Counts = dict[str, int]


class Truth:
    """Poses of the stones of a run, ten times a second."""

    def __init__(self, path: Path) -> None:
        with np.load(path) as kept:
            self.stamps_s, self.T_stones = kept["stamps_s"], kept["T_stones"]

    def at(self, stone: int, time_s: float) -> np.ndarray:
        i = int(
            np.clip(
                np.searchsorted(self.stamps_s, time_s, side="right") - 1, 0, len(self.stamps_s) - 2
            )
        )
        fraction = (time_s - self.stamps_s[i]) / (self.stamps_s[i + 1] - self.stamps_s[i])
        return interpolate(
            self.T_stones[i, stone], self.T_stones[i + 1, stone], float(np.clip(fraction, 0, 1))
        )

    def nearest(self, point: np.ndarray, time_s: float) -> int | None:
        distances = [
            np.linalg.norm(self.at(i, time_s)[:3, 3] - point) for i in range(self.T_stones.shape[1])
        ]
        return int(np.argmin(distances)) if min(distances) < SAME_STONE_M else None


def run(seed: int, folder: Path, overrides: Sequence[str]) -> None:
    """Run the mission and keep the true poses of the stones."""
    made = Run(load_mission("relocate", overrides), Options(seed=seed, run_dir=folder))
    logs = []

    def look(mission: object) -> None:
        logs[:] = [mission.services.plugins["robot"].truth_log]

    print(made.execute(look).summary, file=sys.stderr, flush=True)
    write_truth(folder, logs[0])


def write_truth(folder: Path, log: Any) -> None:
    """Keep where all stones were throughout a run."""
    np.savez_compressed(folder / TRUTH, stamps_s=log._stamps_s, T_stones=np.array(log._T_stones))


def errors_of(folder: Path) -> tuple[Entries, Counts]:
    """Return an entry for each realignment (stone, round, place in cm, turning in degrees, both
    before), and counts.
    """
    truth, entries = Truth(folder / TRUTH), []
    plugin = registry.load("objects", "sqlite")
    database = plugin(plugin.Settings())
    database.open(str(folder / "objects.sqlite"), read_only=True)
    stones = database.stones()
    partners = {}
    for stone in stones:
        history = database.history(stone.id)
        partners[stone.id] = truth.nearest(history[0].T_map_object[:3, 3], history[0].stamp_s)
        if partners[stone.id] is None:
            continue
        error = error_after(truth, partners[stone.id], history[0])
        releases = [i for i, event in enumerate(history) if event.kind == "release"]
        for number, i in enumerate(releases):
            last = releases[number + 1] if number + 1 < len(releases) else len(history)
            realigned = [event for event in history[i:last] if event.kind == "realign"]
            settled, final = error(history[i]), error(realigned[0] if realigned else history[i])
            entries.append(
                {
                    "round": number,
                    "settled": settled,
                    "final": final,
                    "was_realigned": bool(realigned),
                }
            )
    database.close()
    known = [partner for partner in partners.values() if partner is not None]
    counts = {
        "stones": truth.T_stones.shape[1],
        "known": len(set(known)),
        "twice": len(known) - len(set(known)),
    }
    return entries, counts | {"ghosts": len(stones) - len(known)}


def error_after(truth: Truth, stone: int, first: object) -> Callable:
    """Return a function from a later event to the error of its pose: (cm, degrees)."""
    T_first_object = inverse(truth.at(stone, first.stamp_s)) @ first.T_map_object

    def error(event: object) -> tuple[float, float]:
        T_expected = truth.at(stone, event.stamp_s) @ T_first_object
        turning = angle_between(T_expected[:3, :3], event.T_map_object[:3, :3])
        return 100 * float(np.linalg.norm(T_expected[:3, 3] - event.T_map_object[:3, 3])), float(
            np.degrees(turning)
        )

    return error


def report(name: str, folder: Path) -> tuple[Entries, Counts]:
    entries, counts = errors_of(folder)
    print(
        f"{name}: {counts['known']} of {counts['stones']} stones known, {counts['twice']} twice, "
        f"{counts['ghosts']} that are none; {len(entries)} relocations"
    )
    for number in sorted({entry["round"] for entry in entries}):
        line(f"  round {number + 1}", [entry for entry in entries if entry["round"] == number])
    return entries, counts


def line(name: str, entries: Sequence[dict]) -> None:
    settled, final = (np.array([entry[key] for entry in entries]) for key in ("settled", "final"))
    figures = [np.median(final, axis=0), np.percentile(final, 90, axis=0), final.max(axis=0)]
    realigned = sum(entry["was_realigned"] for entry in entries)
    before = " ".join(f"{value:6.1f}" for value in np.median(settled, axis=0))
    place, turning = (" ".join(f"{figure[i]:6.2f}" for figure in figures) for i in (0, 1))
    print(f"{name:10} {len(entries):3} {realigned:10}   {before}   {place}   {turning}", flush=True)


def kept(folders: Sequence[Path]) -> Iterator[tuple[Entries, Counts]]:
    """Measure folders that an earlier run has kept."""
    for folder in folders:
        yield report(str(folder), folder)


def made(
    seeds: Sequence[int], kept_in: Path | None, settings: Sequence[str]
) -> Iterator[tuple[Entries, Counts]]:
    """Run the mission with each seed and measure its folder."""
    with tempfile.TemporaryDirectory() as scratch:
        for seed in seeds:
            folder = (kept_in or Path(scratch)) / str(seed)
            run(seed, folder, settings)
            yield report(f"seed {seed}", folder)


def figures(runs: Sequence[tuple[Entries, Counts]]) -> list[Figure]:
    """Hold the poses after the realignment and the identities of the stones against bounds."""
    entries = [entry for found, _ in runs for entry in found]
    if entries:
        line("all", entries)
    realigned = [entry["final"] for entry in entries if entry["was_realigned"]]
    cm, deg = np.array(realigned or [(np.nan, np.nan)]).T
    counts = {name: sum(one[name] for _, one in runs) for name in runs[0][1]}
    known = f"{counts['known']} of {counts['stones']}"
    return [
        held(f"place after realignment, worst of {len(realigned)} [cm]", cm.max(), NEAR_CM),
        held(f"rotation after realignment, worst of {len(realigned)} [°]", deg.max(), NEAR_DEG),
        judged("stones known", known, "all", counts["known"] == counts["stones"]),
        held("stones known twice", counts["twice"], Bound(0)),
        held("objects that are no stone", counts["ghosts"], Bound(0)),
    ]
