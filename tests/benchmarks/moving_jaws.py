"""Measure whether the jaws of the simulated arm move evenly, and come to rest, in drawn postures.

In each posture, free of contacts, the jaws go from one drawn angle to another one with a drawn
force. While they move at their full speed, the torque of their drive is that of a free motion; one
second after they have arrived, none of the two moves. Nothing is in the jaws. Run it with
OMP_NUM_THREADS=1. A tenth of a second of processor time a posture.
"""

import sys
from collections.abc import Sequence

from bounds import command_line, count, verdict

USAGE = """
python tests/benchmarks/moving_jaws.py --postures 200 --seed 7
python tests/benchmarks/moving_jaws.py --machine mini
"""


def main(words: Sequence[str] | None = None) -> int:
    parser = command_line(__doc__, USAGE)
    parser.add_argument("--machine", default="m545", help="the machine (default: m545)")
    parser.add_argument("--postures", type=count, default=200, help="postures (default: 200)")
    parser.add_argument("--seed", type=int, default=1, help="seed of postures, angles and forces")
    given = parser.parse_args(words)

    from trials.moving_jaws import figures, measured

    return verdict(figures(measured(given.machine, given.postures, given.seed)))


if __name__ == "__main__":
    sys.exit(main())
