"""Measure whether stones come to rest on rough ground after they are released, in each scenario.

Stones of the site's generators, and scans of a folder, are released just above the ground in any
orientation, as from the jaws, and left alone for 5 s. Then the largest distance that any corner of
a stone moves within 5 s is measured; at rest is less than 1 mm. MuJoCo's sleep is off, and nothing
is damped by hand. The scenario `kind` is measured beside the others, without a bound.
"""

import sys
from collections.abc import Sequence
from pathlib import Path

from bounds import command_line, count, refused, verdict

STONES = Path(__file__).parents[3] / "shared" / "data" / "stones"
SCENARIOS = ("kind", "nominal", "wet", "harsh")
USAGE = """
python tests/benchmarks/stones_at_rest.py
python tests/benchmarks/stones_at_rest.py --number 12 --scenario kind nominal --seed 7
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--number", type=count, default=42, help="stones of each kind")
    parser.add_argument("--seed", type=int, default=1, help="seed of shapes, poses and ground")
    parser.add_argument("--scenario", choices=SCENARIOS, nargs="+", default=list(SCENARIOS))
    parser.add_argument("--stones", type=Path, default=STONES, help="folder of scans")
    parser.add_argument("--scale", type=float, default=10.0, help="factor on the scans")
    given = parser.parse_args(words)

    from trials.stones_at_rest import figures, generated, scanned

    kinds = {"generated stones": generated(given.number, given.seed)}
    with refused(parser):
        if given.stones.is_dir():
            kinds["scans"] = scanned(given.number, given.stones, given.scale, given.seed)
        else:
            print(f"no scans: '{given.stones}' is no folder", file=sys.stderr)
    told = []
    for scenario in given.scenario:
        for name, stones in kinds.items():
            told.append(figures(name, stones, scenario, given.seed))
            print(f"{told[-1].what}: {told[-1].value}", flush=True)
    return verdict(told)


if __name__ == "__main__":
    sys.exit(main())
