"""Run the mapping mission over seeds and print when the drone's map was first registered, one line a seed.

    OMP_NUM_THREADS=1 python tests/benchmarks/perception/first_success.py 1 2 3
    OMP_NUM_THREADS=1 python tests/benchmarks/perception/first_success.py 1 2 3 -- registration.plugin=segment_fpfh

Times are the mission's, from the first movement of the swing. The paper's first success came after 15 s (Sec. 6.2).
Fifteen seconds of processor time a seed.
"""

import json
import sys
import tempfile
from pathlib import Path

import numpy as np

from executive.mission.run import Options, Run
from executive.tree.load import load_mission


def line(journal: list[dict], report: dict, seed: int) -> tuple[str, float, bool]:
    """Return a line for people, the time of the first success [s] (inf if none), and whether all is as it should be."""
    tried = [entry for entry in journal if entry["kind"] == "registration"]
    dense = [entry for entry in journal if entry["kind"] == "dense"]
    begun_s = dense[0]["time_s"] - dense[0]["payload"]["waited_s"] if dense else 0.0
    accepted = [entry for entry in tried if entry["payload"]["accepted"]]
    first_s = accepted[0]["time_s"] - begun_s if accepted else np.inf
    errors = [s["database_error_m"] for s in report["truth"]["stones"] if s["database_error_m"] is not None]
    stones = accepted[0]["payload"]["matched_segments"] if accepted else 0
    dense_s = dense[0]["payload"]["waited_s"] if dense else np.nan
    is_right = bool(errors) and float(np.median(errors)) < 0.10  # a wrong motion would put stones aside by metres
    text = (
        f"{seed:4d} {dense_s:8.1f} {first_s:8.1f} {len(tried):8d} {stones:7d} {len(errors):6d}"
        f" {100 * np.median(errors) if errors else np.nan:9.1f}"
    )
    return text, first_s, is_right


def main(seeds: list[int], overrides: list[str]) -> None:
    print("seed  dense_s  first_s attempts matched stones median_cm", flush=True)
    times, right = [], 0
    with tempfile.TemporaryDirectory() as folder:
        for seed in seeds:
            run_dir = Path(folder) / str(seed)
            made = Run(load_mission("map_site", overrides), Options(seed=seed, run_dir=run_dir))
            report = made.execute(lambda mission: None).report
            journal = [json.loads(row) for row in (run_dir / "journal.jsonl").read_text().splitlines()]
            text, first_s, is_right = line(journal, report, seed)
            print(text, flush=True)
            times.append(first_s)
            right += is_right
    print(
        f"first success: median {np.median(times):.1f} s, worst {max(times):.1f} s, after 5 s {np.mean(np.array(times) <= 5):.0%},"
        f" after 10 s {np.mean(np.array(times) <= 10):.0%} of {len(times)}; stones where they are in {right}"
    )


if __name__ == "__main__":
    words = sys.argv[1:]
    cut = words.index("--") if "--" in words else len(words)
    main([int(word) for word in words[:cut]] or [1], words[cut + 1 :])
