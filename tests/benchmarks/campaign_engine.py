"""Measure what a campaign adds to its runs, how it uses the cores, and what kills cost it.

A short mission without physics (a second of processor time) is run again and again on two cores.
Then a campaign of runs of 0.3 s has a process killed by signal 9 at random moments, again and
again: in turn the campaign itself, the process that forks its runs, and one of its runs. A killed
campaign is begun anew, as `--resume` does. At the end no trial may lack its outcome, have two, or
one that does not say what happened. The figures of time are meant for a computer with nothing else
to do; its load is printed.
"""

import os
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from bounds import Bound, Figure, command_line, count, held, verdict

USAGE = """
OMP_NUM_THREADS=1 python tests/benchmarks/campaign_engine.py
OMP_NUM_THREADS=1 python tests/benchmarks/campaign_engine.py --runs 40 --kills 10
"""
OVERHEAD = Bound(1.5, 0.3)
IN_USE = Bound(0.90, 0.97, is_least=True)
NONE = Bound(0)


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--runs", type=count, default=200, help="short missions (default: 200)")
    parser.add_argument("--jobs", type=count, default=2, help="runs side by side (default: 2)")
    parser.add_argument("--kills", type=count, default=100, help="kills (default: 100)")
    parser.add_argument("--seed", type=int, default=1, help="of the moments of the kills")
    given = parser.parse_args(words)

    with tempfile.TemporaryDirectory() as folder:
        figures = [
            *_spread(Path(folder) / "spread", given.jobs, given.runs),
            *_killed(Path(folder) / "killed", given.kills, given.seed),
        ]
    return verdict(figures)


def _spread(folder: Path, jobs: int, runs: int) -> list[Figure]:
    from trials.campaign_engine import spread_over

    print(f"load before: {os.getloadavg()[0]:.1f}, cores: {os.cpu_count()}", flush=True)
    found = spread_over(jobs, folder, runs)
    print(f"load after: {os.getloadavg()[0]:.1f}", flush=True)
    missing = held("short missions without an answer", runs - found.done, NONE)
    return [
        missing,
        Figure("beside the first mission's own time, with the imports [s]", f"{found.first_s:.2f}"),
        held("beside a mission's own time, median [s]", found.overhead_s, OVERHEAD),
        held(f"share of {jobs} slots in use over {runs} runs", found.in_use, IN_USE),
    ]


def _killed(folder: Path, kills: int, seed: int) -> list[Figure]:
    import numpy as np
    from trials.campaign_engine import killed_at_random

    folder.mkdir()
    tally = killed_at_random(folder, kills, np.random.default_rng(seed), runs=4 * kills)
    said = ", ".join(f"{n} {target}" for target, n in sorted(tally.kills.items()))
    ends = ", ".join(f"{n} {status.value}" for status, n in sorted(tally.statuses.items(), key=str))
    least = Bound(kills, is_least=True)
    return [
        held(f"kills over {tally.runs} runs", tally.kills.total(), least, f"{kills}: {said}"),
        Figure("outcomes", ends),
        held("runs lost", len(tally.lost), NONE),
        held("runs doubled", len(tally.doubled), NONE),
        held("runs wrongly counted", len(tally.wrong), NONE),
    ]


if __name__ == "__main__":
    sys.exit(main())
