"""Read damaged files: `python -m tests.hostile --format laz --count 10000 --seed 1`.

Files of a format are damaged at random and read by a child process with a guard of memory, so that
a crash or a hang costs one file. For each format it prints how many were read and refused, what
went wrong, and the worst processor time and memory; the exit status is 1 if anything did. A
file is known by its format, seed and number: `--first 4711 --count 1 --keep bad` writes it again.
"""

import argparse
import sys
from collections import Counter
from pathlib import Path

from tests.hostile.formats import FORMATS
from tests.hostile.guarded import Ended, answers

_SHOWN = 3  # misses of each kind that are printed in full


def main() -> int:
    """Run the formats that are asked for; return the exit status."""
    told = argparse.ArgumentParser(prog="python -m tests.hostile", description=__doc__)
    told.add_argument("--format", choices=[*FORMATS, "all"], default="all")
    told.add_argument("--count", type=int, default=1000, help="files of each format")
    told.add_argument("--seed", type=int, default=1)
    told.add_argument("--first", type=int, default=0, help="number of the first file")
    told.add_argument("--keep", type=Path, help="folder for the files that miss a bound")
    asked = told.parse_args()
    names = list(FORMATS) if asked.format == "all" else [asked.format]
    missed = [_tell(name, asked) for name in names]
    return int(any(missed))


def _tell(name: str, asked: argparse.Namespace) -> bool:
    counts: Counter[str] = Counter()
    worst_s = worst_bytes = 0.0
    numbers = range(asked.first, asked.first + asked.count)
    for number, content, answer in answers(name, asked.seed, numbers):
        if isinstance(answer, Ended):
            missed, text = [answer.outcome], answer.text
        else:
            missed, text = answer.misses(), answer.text
            counts[answer.outcome] += answer.outcome in ("read", "refused")
            worst_s = max(worst_s, answer.processor_s)
            worst_bytes = max(worst_bytes, answer.added_bytes)
        for one in missed:
            counts[one] += 1
            if counts[one] <= _SHOWN:
                print(f"{name} {number}: {one}: {text[-1500:]}", file=sys.stderr, flush=True)
        if asked.keep and (missed or asked.count == 1):
            asked.keep.mkdir(parents=True, exist_ok=True)
            (asked.keep / f"{name}-{asked.seed}-{number}").write_bytes(content)
    kinds = ("read", "refused", "unnamed", "traceback", "crash", "hang", "memory")
    line = ", ".join(f"{counts[kind]} {kind}" for kind in kinds)
    print(
        f"{name}: {asked.count} files of seed {asked.seed}: {line}; at worst {worst_s:.2f} s of "
        f"processor time and {worst_bytes / 1e6:.0f} MB",
        flush=True,
    )
    return any(counts[kind] for kind in kinds[2:])


if __name__ == "__main__":
    sys.exit(main())
