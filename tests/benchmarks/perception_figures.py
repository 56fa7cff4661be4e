"""Measure what perception is held to, and print it as tables beside the paper's Table 1.

Figures are kept part by part in docs/perception_figures.json, or in the file of --figures, and the
page on perception shows the tables; a run measures the parts that are named, else all, and judges
what the file holds then. Milliseconds are processor time of one thread: run
it with OMP_NUM_THREADS=1. An hour on an idle core, most of it for `first_success` and `scan_pair`.
"""

import json
import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, verdict

FIGURES = Path(__file__).parents[2] / "docs" / "perception_figures.json"
USAGE = """
OMP_NUM_THREADS=1 python tests/benchmarks/perception_figures.py
OMP_NUM_THREADS=1 python tests/benchmarks/perception_figures.py swing_20_s same_bits
python tests/benchmarks/perception_figures.py --print                 what was measured last
"""
PARTS = (
    "swing_20_s",
    "swing_10_s",
    "wrong_sites",
    "stretched",
    "segmentation",
    "same_bits",
    "neighbours",
    "first_success",
    "scan_pair",
)


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(PARTS)}")
    parser.add_argument("--print", action="store_true", dest="is_read", help="measure nothing")
    parser.add_argument("--figures", type=Path, default=FIGURES, help="file of the figures")
    given = parser.parse_args(words)
    if unknown := set(given.parts) - set(PARTS):
        parser.error(f"no part {', '.join(sorted(unknown))}; there are {', '.join(PARTS)}")

    from trials import perception_figures as measured

    if not given.is_read:
        for part in given.parts or PARTS:
            measured.keep(part, measured.PARTS[part](), given.figures)
            print(f"{part} measured", file=sys.stderr, flush=True)
    try:
        figures = measured.read(given.figures)
    except (OSError, json.JSONDecodeError) as error:
        parser.error(f"{given.figures}: {error}")
    print("\n\n".join(measured.tables(figures)))
    return verdict(measured.held(figures))


if __name__ == "__main__":
    sys.exit(main())
