"""Measure the object database against the truth over four rounds of relocations, one line a round.

    python tests/benchmarks/database_poses.py 2 3             run `relocate` with these seeds, then
    measure python tests/benchmarks/database_poses.py --keep runs 2   the same, and keep the run
    folders in runs/ python tests/benchmarks/database_poses.py --read runs/2   measure a folder that
    was kept

What follows `--` are settings, as of `executive run --set`. A seed takes 25 minutes on the
mission's clock, and less on an idle core. A stone's database pose should have changed, since it was
found, as the stone itself has moved: the error is what is left between both, in place (of the
object's origin) and in turning. `settled` is before the realignment: how far the stone moved when
the jaws let go, and how far Eq. 3 is off.
"""

import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from executive import registry
from executive.geometry.pose import interpolate, inverse
from executive.geometry.rotation import angle_between
from executive.mission.run import Options, Run
from executive.tree.load import load_mission

TRUTH = "truth.npz"
SAME_STONE_M = 0.7


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
    """Run the mission and write down what the simulator knew."""
    made = Run(load_mission("relocate", overrides), Options(seed=seed, run_dir=folder))
    logs = []

    def look(mission: object) -> None:
        logs[:] = [mission.services.plugins["robot"].truth_log]

    print(made.execute(look).summary, file=sys.stderr, flush=True)
    write_truth(folder, logs[0])


def write_truth(folder: Path, log: Any) -> None:
    """Keep where all stones were throughout a run."""
    np.savez_compressed(folder / TRUTH, stamps_s=log._stamps_s, T_stones=np.array(log._T_stones))


def errors_of(folder: Path) -> tuple[list[dict], dict[str, int]]:
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
    """Return what tells how far a later event's pose is off: (cm, degrees)."""
    T_first_object = inverse(truth.at(stone, first.stamp_s)) @ first.T_map_object

    def error(event: object) -> tuple[float, float]:
        T_expected = truth.at(stone, event.stamp_s) @ T_first_object
        turning = angle_between(T_expected[:3, :3], event.T_map_object[:3, :3])
        return 100 * float(np.linalg.norm(T_expected[:3, 3] - event.T_map_object[:3, 3])), float(
            np.degrees(turning)
        )

    return error


def report(name: str, folder: Path) -> list[dict]:
    entries, counts = errors_of(folder)
    print(
        f"{name}: {counts['known']} of {counts['stones']} stones known, {counts['twice']} twice, "
        f"{counts['ghosts']} that are none; {len(entries)} relocations"
    )
    for number in sorted({entry["round"] for entry in entries}):
        line(f"  round {number + 1}", [entry for entry in entries if entry["round"] == number])
    return entries


def line(name: str, entries: Sequence[dict]) -> None:
    settled, final = (np.array([entry[key] for entry in entries]) for key in ("settled", "final"))
    figures = [np.median(final, axis=0), np.percentile(final, 90, axis=0), final.max(axis=0)]
    realigned = sum(entry["was_realigned"] for entry in entries)
    before = " ".join(f"{value:6.1f}" for value in np.median(settled, axis=0))
    place, turning = (" ".join(f"{figure[i]:6.2f}" for figure in figures) for i in (0, 1))
    print(f"{name:10} {len(entries):3} {realigned:10}   {before}   {place}   {turning}", flush=True)


def main(words: list[str]) -> None:
    cut = words.index("--") if "--" in words else len(words)
    words, overrides = words[:cut], words[cut + 1 :]
    print(
        "              n  realigned   settled cm, °   cm: median p90    worst   °: "
        "median p90    worst"
    )
    everything = []
    if words[:1] == ["--read"]:
        for folder in words[1:]:
            everything += report(folder, Path(folder))
    else:
        kept = Path(words[1]) if words[:1] == ["--keep"] else None
        words = words[2:] if kept else words
        with tempfile.TemporaryDirectory() as scratch:
            for seed in map(int, words):
                folder = (kept or Path(scratch)) / str(seed)
                run(seed, folder, overrides)
                everything += report(f"seed {seed}", folder)
    if everything:
        line("all", everything)


if __name__ == "__main__":
    main(sys.argv[1:])
