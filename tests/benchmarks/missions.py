"""Run whole missions over seeds and print what came of them, one line a seed.

    python tests/benchmarks/missions.py 1 2 3 4 5
    python tests/benchmarks/missions.py 1 2 3 -- robot.site.stones.folder=DIR
    robot.site.stones.scale=10

What follows `--` are settings, as of `executive run --set`. Two minutes a seed on an idle core.
"""

import sys
import tempfile
from pathlib import Path

from executive.mission.run import Options, Run
from executive.tree.load import load_mission

NEAR_M = 0.30


def line(report: dict, seed: int) -> str:
    truth, counts = report["truth"], report["counts"]
    errors = sorted(s["slot_error_m"] for s in truth["stones"] if s["slot_error_m"] is not None)
    near = sum(error <= NEAR_M for error in errors)
    middle = errors[len(errors) // 2] if errors else float("nan")
    worst = errors[-1] if errors else float("nan")
    return (
        f"{seed:4d}  {report['outcome']:8} {near:2d}/{len(truth['stones']):<2d} "
        f"{middle:6.2f} {worst:6.2f}"
        f" {counts['first_attempt']:6d} {counts['attempts']:8d} {counts['slips']:5d} "
        f"{counts['drops']:5d}"
        f" {len(truth['collisions']):10d} {report['ended_s']:8.0f} "
        f"{report['real_time_factor']:6.1f}"
    )


def main(seeds: list[int], overrides: list[str]) -> None:
    print(
        "seed  outcome  near   median  worst  first attempts slips drops collisions   "
        "time_s  ratio",
        flush=True,
    )
    with tempfile.TemporaryDirectory() as folder:
        for seed in seeds:
            description = load_mission("pick_and_place", overrides)
            made = Run(description, Options(seed=seed, run_dir=Path(folder) / str(seed)))
            print(line(made.execute(lambda mission: None).report, seed), flush=True)


if __name__ == "__main__":
    words = sys.argv[1:]
    cut = words.index("--") if "--" in words else len(words)
    main([int(word) for word in words[:cut]] or [1], words[cut + 1 :])
